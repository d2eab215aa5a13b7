import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';
import { Writer } from '../mock/bytes.mjs';

const { readMesh, readGrid, creasedNormals, gridGeometry } = await load('scene/assets.ts');

function triangle() {
  const w = new Writer().u32(0x314d4c53).u32(3).u32(1).u32(1).u32(1);
  for (const c of [0, 0, 0, 1, 0, 0, 0, 1, 0]) w.f32(c);
  for (const c of [0, 0, 1, 0, 0, 1]) w.f32(c);
  w.u32(0).u32(1).u32(2);
  return w.u32(0).u32(1).f32(0.5).f32(0.25).f32(0.125).f32(1).u32(3);
}

test('a mesh is read with its parts', () => {
  const mesh = readMesh(triangle().arrayBuffer());
  assert.deepEqual([...mesh.positions], [0, 0, 0, 1, 0, 0, 0, 1, 0]);
  assert.deepEqual([...mesh.uvs], [0, 0, 1, 0, 0, 1]);
  assert.deepEqual(mesh.parts, [{ first: 0, triangles: 1, color: [0.5, 0.25, 0.125, 1], texture: 2 }]);
});

test('damaged meshes are refused', () => {
  const whole = new Uint8Array(triangle().arrayBuffer());
  for (let length = 0; length < whole.length; ++length) assert.equal(readMesh(whole.slice(0, length).buffer), undefined, `${length} bytes`);
  const change = (at, value) => {
    const bytes = whole.slice();
    new DataView(bytes.buffer).setUint32(at, value, true);
    return readMesh(bytes.buffer);
  };
  assert.equal(change(0, 1), undefined);
  assert.equal(change(4, 0xffffffff), undefined);
  assert.equal(change(20 + 36 + 24, 3), undefined); // an index of no vertex
  assert.equal(change(20, 0x7fc00000), undefined); // NaN
  assert.equal(change(20 + 36 + 24 + 12 + 4, 2), undefined); // a part beyond the triangles
});

test('normals are smooth over what bends little and keep a crease', () => {
  // Two triangles that share the edge from the origin along y, bent by an angle about it.
  const fold = (angle) => {
    const c = Math.cos(angle), s = Math.sin(angle);
    // The second has points of its own at the same places: sameness is by place, not by index.
    const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -c, 0, -s]);
    return creasedNormals(positions, [0, 1, 2, 3, 4, 5]);
  };
  const flat = fold((20 * Math.PI) / 180);
  // At the shared origin: the mean of (0, 0, 1) and that turned by 20 degrees, which is at 10 degrees.
  assert.ok(Math.abs(Math.acos(flat[2]) - (10 * Math.PI) / 180) < 1e-3, `${flat}`);
  assert.ok(Math.abs(flat[5] - 1) < 1e-6); // at x = 1 only one face
  const sharp = fold((60 * Math.PI) / 180);
  assert.ok(Math.abs(sharp[2] - 1) < 1e-6);
});

test('a grid lies centred, x first, and faces up', () => {
  const w = new Writer().u32(0x31474c53).u32(3).u32(2).f32(4).f32(10);
  for (const h of [0, 1, 2, 3, 4, 5]) w.f32(h);
  const grid = readGrid(w.arrayBuffer());
  const geometry = gridGeometry(grid);
  const p = geometry.getAttribute('position');
  assert.deepEqual([p.getX(0), p.getY(0), p.getZ(0)], [-2, -5, 0]);
  assert.deepEqual([p.getX(5), p.getY(5), p.getZ(5)], [2, 5, 5]);
  assert.deepEqual([p.getX(1), p.getZ(1)], [0, 1]);
  assert.ok(geometry.getAttribute('normal').getZ(0) > 0);
  // Split from the corner of least x and y to the opposite one.
  assert.deepEqual([...geometry.index.array.slice(0, 6)], [0, 1, 4, 0, 4, 3]);
  assert.equal(readGrid(w.arrayBuffer().slice(0, -4)), undefined);
});
