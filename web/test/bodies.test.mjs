import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

// One bundle, so that all share one three.js.
const { Assets, Bodies, pickSlots, THREE } = await load('../test/bodies_entry.ts');

const IDENTITY = [0, 0, 0, 1, 0, 0, 0];
const box = (size, diffuse) => ({ name: '', pose: IDENTITY, shape: { type: 'box', size }, material: { diffuse } });
const model = (id, visuals) => ({ id, name: id, static: false, links: [{ name: 'link', pose: IDENTITY, parent: -1, joint: -1, visuals, collisions: [] }], joints: [] });
const instance = (id, name, model_id, x) => ({ id, name, original: '', model: model_id, robot: false, team: '', pose: [x, 0, 0, 1, 0, 0, 0], devices: [], controllers: [] });
const world = (models, instances, epoch = 1) => ({ epoch, revision: 1, lights: [], models, instances });

function bodies() {
  return new Bodies(new THREE.Group(), new Assets('/none', () => {}), () => {});
}

/** Names hit by a ray down at x. */
function below(stand, x) {
  const hit = pickSlots(new THREE.Ray(new THREE.Vector3(x, 0, 10), new THREE.Vector3(0, 0, -1)), stand.batches.all);
  return hit && [hit.slot.owner.instance.name, Math.round(1000 * hit.distance_m) / 1000];
}

test('boxes of any size and colour are one batch, and a ray meets them where they are', () => {
  const stand = bodies();
  const models = [model('a', [box([1, 1, 1], [1, 0, 0, 1])]), model('b', [box([1, 1, 3], [0, 1, 0, 1])])];
  stand.setWorld(world(models, [instance(1, 'low', 'a', 0), instance(2, 'high', 'b', 5)]));
  stand.update();
  assert.equal([...stand.batches.all].length, 1);
  assert.deepEqual(below(stand, 0), ['low', 9.5]);
  assert.deepEqual(below(stand, 5), ['high', 8.5]);
  assert.equal(below(stand, 2), null);
});

test('what goes leaves no copy, and the others stay where they are', () => {
  const stand = bodies();
  const models = [model('a', [box([1, 1, 1], [1, 0, 0, 1])])];
  const all = Array.from({ length: 100 }, (_, i) => instance(i, `n${i}`, 'a', 2 * i));
  stand.setWorld(world(models, all));
  stand.update();
  const kept = all.filter((_, i) => i % 3 !== 0);
  const object = stand.by_id.get(1);
  stand.setWorld(world(models, kept));
  stand.update();
  assert.equal(stand.by_id.get(1), object);
  for (let i = 0; i < 100; ++i) assert.deepEqual(below(stand, 2 * i), i % 3 === 0 ? null : [`n${i}`, 9.5]);
  stand.setWorld(world([], []));
  assert.equal([...stand.batches.all].length, 0);
});

test('an epoch tells everything anew, a model of other content too', () => {
  const stand = bodies();
  const small = [model('a', [box([1, 1, 1], [1, 0, 0, 1])])];
  stand.setWorld(world(small, [instance(1, 'x', 'a', 0)]));
  const first = stand.by_id.get(1);
  stand.setWorld(world(small, [instance(1, 'x', 'a', 0)], 2));
  assert.notEqual(stand.by_id.get(1), first);
  stand.setWorld(world([model('a', [box([1, 1, 4], [1, 0, 0, 1])])], [instance(1, 'x', 'a', 0)], 2));
  stand.update();
  assert.deepEqual(below(stand, 0), ['x', 8]);
});

test('plain visuals of a link are one part, and robots of another colour share their wheels', () => {
  const stand = bodies();
  const wheels = [box([1, 1, 1], [0, 0, 0, 1]), box([2, 1, 1], [0.5, 0, 0, 1])];
  const two = (id, color) => ({ ...model(id, [box([3, 3, 3], color), box([1, 3, 3], color)]), links: [
    { name: 'base', pose: IDENTITY, parent: -1, joint: -1, visuals: [box([3, 3, 3], color), box([1, 3, 3], color)], collisions: [] },
    { name: 'wheel', pose: IDENTITY, parent: 0, joint: -1, visuals: wheels, collisions: [] }] });
  stand.setWorld(world([two('a', [1, 0, 0, 1]), two('b', [0, 1, 0, 1])], [instance(1, 'x', 'a', 0), instance(2, 'y', 'b', 9)]));
  assert.deepEqual([...stand.batches.all].map((b) => b.slots.length).sort(), [1, 1, 2]);
});

test('speed and heading rate come from two messages', () => {
  const stand = bodies();
  stand.setWorld(world([model('a', [box([1, 1, 1], [1, 0, 0, 1])])], [instance(1, 'x', 'a', 0)]));
  const body = stand.by_id.get(1);
  body.values.set([0, 0, 0, 1, 0, 0, 0]);
  body.take(1, stand.scratch);
  body.values.set([0.5, -0.25, 0, Math.cos(0.05), 0, 0, Math.sin(0.05)]); // 0.1 rad
  body.take(1.25, stand.scratch);
  assert.deepEqual([...body.velocity], [2, -1, 0]);
  assert.ok(Math.abs(body.yaw_rate - 0.4) < 1e-12);
  body.values[0] = NaN;
  assert.equal(body.take(1.5, stand.scratch), false);
  assert.equal(body.world[0], 0.5);
});

test('an override moves all links with the first', () => {
  const stand = bodies();
  const long = { ...model('a', []), links: [0, 1].map((i) => ({ name: `l${i}`, pose: [i, 0, 0, 1, 0, 0, 0], parent: i - 1, joint: -1, visuals: [], collisions: [] })) };
  stand.setWorld(world([long], [instance(1, 'x', 'a', 0)]));
  const body = stand.by_id.get(1);
  body.override([5, 5, 0, Math.SQRT1_2, 0, 0, Math.SQRT1_2], stand.scratch);
  for (const [i, v] of [5, 6, 0].entries()) assert.ok(Math.abs(body.world[7 + i] - v) < 1e-12, `${body.world}`);
});

test('a device is where it was when it measured', () => {
  const stand = bodies();
  const models = [model('a', [box([1, 1, 1], [1, 0, 0, 1])])];
  const device = { name: 'laser', path: 'one/laser', kind: 'laser_scanner', link: 0, pose: [2, 0, 0.5, 1, 0, 0, 0], active: [], topics: [], commands: [] };
  stand.setWorld(world(models, [{ ...instance(1, 'one', 'a', 0), devices: [device] }]));
  const one = stand.by_name.get('one');
  // From heading 0 at the origin to a quarter turn at (1, 0), in 0.2 s: 5 m/s, 2.5 pi rad/s.
  one.form = 1;
  for (const [t, x, yaw] of [[0.8, 0, 0], [1, 1, Math.PI / 2]]) {
    one.world.set([x, 0, 0, Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)]);
    one.values.set(one.world);
    one.take(t, stand.scratch);
  }
  const at = new Float64Array(7);
  const near = (expected) => expected.forEach((v, i) => assert.ok(Math.abs(at[i] - v) < 1e-9, `${i}: ${at[i]} ${v}`));
  one.devicePoseAt(device, 1, at);
  near([1, 2, 0.5, Math.SQRT1_2, 0, 0, Math.SQRT1_2]);
  one.devicePoseAt(device, 0.9, at);
  // An eighth of a turn and half a metre earlier.
  near([0.5 + Math.SQRT2, Math.SQRT2, 0.5, Math.cos(Math.PI / 8), 0, 0, Math.sin(Math.PI / 8)]);
  // Of another time there is no telling.
  one.devicePoseAt(device, 5, at);
  near([1, 2, 0.5]);
});
