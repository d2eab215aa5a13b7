import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { CameraRig, THREE } = await load('../test/bodies_entry.ts');
const never = () => false;

function settled(rig, subject = null, seconds = 5) {
  for (let i = 0; i < 60 * seconds; ++i) rig.update(1 / 60, subject, never);
  rig.camera.updateMatrixWorld();
  rig.camera.matrixWorldInverse.copy(rig.camera.matrixWorld).invert();
  return rig.camera;
}

const subject = (x, y, yaw_rad) => ({
  position: new THREE.Vector3(x, y, 0.1), yaw_rad, radius_m: 0.3, eye: new THREE.Vector3(x, y, 0.2), forward: new THREE.Vector3(Math.cos(yaw_rad), Math.sin(yaw_rad), 0), up: new THREE.Vector3(0, 0, 1),
});

test('a framed ball fills the view, also when that is upright', () => {
  for (const aspect of [1.6, 0.5]) {
    const rig = new CameraRig();
    rig.setAspect(aspect);
    const center = new THREE.Vector3(3, -2, 1);
    rig.frame(center, 2);
    const camera = settled(rig);
    // Seen under the angle asin(r / d) to each side; the narrower side of the view holds 1 / 1.15 of it in its half, as
    // the distance was chosen so: sin(seen) = sin(half) / 1.15.
    const half = Math.atan(Math.tan(Math.PI / 8) * Math.min(1, aspect));
    const seen = Math.asin(2 / camera.position.distanceTo(center));
    assert.ok(Math.abs(Math.sin(seen) - Math.sin(half) / 1.15) < 1e-3, `${seen} ${half}`);
    const p = center.clone().project(camera);
    assert.ok(Math.hypot(p.x, p.y) < 1e-3);
  }
});

test('zooming keeps what is under the cursor under the cursor', () => {
  const rig = new CameraRig();
  rig.setAspect(1.5);
  const point = new THREE.Vector3(1, 1, 0);
  const before = point.clone().project(settled(rig));
  rig.zoom(0.5, point);
  const after = point.clone().project(settled(rig));
  assert.ok(Math.hypot(after.x - before.x, after.y - before.y) < 1e-3, `${before.x} ${before.y} ${after.x} ${after.y}`);
});

test('the race camera is behind the robot and above it', () => {
  const rig = new CameraRig();
  const robot = subject(4, 0, Math.PI / 2);
  rig.setMode('race', robot);
  const eye = settled(rig, robot).position;
  assert.ok(Math.abs(eye.x - 4) < 0.02 && eye.y < -1 && eye.z > 0.4, `${eye.toArray()}`);
});

test('follow keeps its angle and distance while the robot drives', () => {
  const rig = new CameraRig();
  rig.setMode('follow', subject(0, 0, 0));
  const first = settled(rig, subject(0, 0, 0)).position.clone();
  const moved = settled(rig, subject(10, 5, 2)).position;
  assert.ok(moved.distanceTo(first.add(new THREE.Vector3(10, 5, 0))) < 1e-2);
});

test('top looks down with north up, the robot camera along the robot, static stays', () => {
  const rig = new CameraRig();
  rig.setMode('top', null);
  const top = settled(rig);
  assert.ok(top.isOrthographicCamera);
  const north = new THREE.Vector3(rig.focus.x, rig.focus.y + 1, 0).project(top);
  assert.ok(Math.abs(north.x) < 1e-6 && north.y > 0);
  const robot = subject(1, 2, 0);
  rig.setMode('robot', robot);
  const eye = settled(rig, robot);
  assert.ok(eye.getWorldDirection(new THREE.Vector3()).distanceTo(new THREE.Vector3(1, 0, 0)) < 1e-6);
  rig.setMode('static', robot);
  const kept = settled(rig, subject(9, 9, 1)).position.clone();
  assert.deepEqual(kept.toArray(), [1, 2, 0.2]);
});

test('television cuts to a stand from which the robot is seen', () => {
  const rig = new CameraRig();
  const robot = subject(0, 0, 0);
  // A wall along the x axis: what is at y > 0 is hidden.
  const wall = (from) => from.y > 0;
  rig.setMode('tv', robot);
  for (let i = 0; i < 200; ++i) rig.update(1 / 60, robot, wall);
  assert.ok(rig.camera.position.y <= 0);
});

test('a yard fills the view, upright or wide, and a narrow view turns to have its long side along it', () => {
  const corners = [];
  for (const x of [-8, 8]) for (const y of [-6, 6]) for (const z of [0, 0.4]) corners.push(new THREE.Vector3(x, y, z));
  const distances = new Map();
  for (const aspect of [1.5, 0.45]) {
    const rig = new CameraRig();
    rig.setAspect(aspect);
    rig.frameAll(corners);
    const camera = settled(rig);
    const seen = corners.map((c) => c.clone().project(camera));
    const most = (of) => Math.max(...seen.map(of));
    // All of it is in the view, off the buttons above, and one of the sides is used up.
    assert.ok(most((p) => Math.abs(p.x)) < 0.97 && most((p) => p.y) < 0.88 && most((p) => -p.y) < 0.96);
    assert.ok(most((p) => Math.abs(p.x)) > 0.9 || most((p) => p.y) - most((p) => -p.y) > 1.7, 'it is as near as may be');
    distances.set(aspect, camera.position.length());
    if (aspect < 1) assert.ok(Math.abs(camera.position.x) > Math.abs(camera.position.y), 'along the long side');
  }
});

test('a long field seen along its length is in the view to its nearest corner', () => {
  const corners = [];
  // Its near end is narrower than its far one, and the eye near to it.
  for (const [x, y] of [[-0.2, -12], [2.8, -12], [-0.2, 4], [5.2, 4], [-0.2, 9], [5.2, 9]]) for (const z of [0, 0.4]) corners.push(new THREE.Vector3(x, y, z));
  const rig = new CameraRig();
  rig.setAspect(1.57);
  rig.frameAll(corners);
  const seen = corners.map((c) => c.clone().project(settled(rig)));
  // The edges that the fit leaves free are met, each by the point that decides: 0.94 of the half to a side or 0.84 up and 0.92 down.
  const side = Math.max(...seen.map((p) => Math.abs(p.x))), top = Math.max(...seen.map((p) => p.y)), bottom = Math.max(...seen.map((p) => -p.y));
  assert.ok(side < 0.945 && top < 0.845 && bottom < 0.925, `${side} ${top} ${bottom}`);
  assert.ok(side > 0.935 || (top > 0.835 && bottom > 0.915), 'it is as near as may be');
});
