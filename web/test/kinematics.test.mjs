import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { Chain } = await load('scene/kinematics.ts');
const { invert, multiply, transform, composeMatrix, localMatrix, yawOf } = await load('scene/poses.ts');

const IDENTITY = [0, 0, 0, 1, 0, 0, 0];
const S = Math.SQRT1_2;
const link = (pose, parent, joint) => ({ name: '', pose, parent, joint, visuals: [], collisions: [] });
const joint = (type, parent, child, pose, axis, thread_pitch_m = 0) => ({ name: '', type, parent, child, pose, axis, lower: null, upper: null, thread_pitch_m });

function placed(model, values, base = IDENTITY) {
  const chain = new Chain(model);
  const slot = { motions: chain.motions, values: new Float64Array(7 * chain.links), form: 0 };
  slot.values.set(base);
  for (const [index, more] of Object.entries(values)) slot.values.set(more, 7 * index);
  const world = new Float64Array(7 * chain.links);
  const ok = chain.place(slot, world, new Float64Array(7 * 8), IDENTITY);
  return { ok, at: (i) => [...world.slice(7 * i, 7 * i + 7)] };
}

function near(actual, expected) {
  for (let i = 0; i < expected.length; ++i) assert.ok(Math.abs(actual[i] - expected[i]) < 1e-12, `${actual} is not ${expected}`);
}

test('a pose times its inverse is nothing, and points go the same way', () => {
  const a = [1, 2, 3, 0.5, 0.5, 0.5, 0.5];
  const inverse = new Float64Array(7);
  const product = new Float64Array(7);
  invert(a, 0, inverse, 0);
  multiply(a, 0, inverse, 0, product, 0);
  near(product, IDENTITY);
  // q = (1, 1, 1, 1) / 2 takes x to y, y to z, z to x.
  const point = [0, 0, 0];
  transform(a, 0, 1, 0, 0, point);
  near(point, [1, 3, 3]);
  assert.ok(Math.abs(yawOf([0, 0, 0, S, 0, 0, S], 0) - Math.PI / 2) < 1e-12);
});

test('a matrix is the pose with the scale in front', () => {
  const local = localMatrix([1, 0, 0, 1, 0, 0, 0], 2, 3, 4);
  const out = new Float32Array(16);
  // Turned by a quarter about z at (5, 0, 0): x goes to y, so the part at x = 1 lies at (5, 1, 0).
  composeMatrix([5, 0, 0, S, 0, 0, S], 0, local, out, 0);
  const expected = [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 5, 1, 0, 1];
  for (let i = 0; i < 16; ++i) assert.ok(Math.abs(out[i] - expected[i]) < 1e-6, `${out}`);
});

test('a hinge away from the link turns the link about the hinge', () => {
  // The link rests at x = 2; the hinge is a metre behind it, at x = 1, about z.
  const model = { links: [link(IDENTITY, -1, -1), link([2, 0, 0, 1, 0, 0, 0], 0, 0)], joints: [joint('revolute', 0, 1, [-1, 0, 0, 1, 0, 0, 0], [0, 0, 1])] };
  near(placed(model, { 1: [Math.PI / 2] }).at(1), [1, 1, 0, S, 0, 0, S]);
});

test('slides and screws go along their axis in J', () => {
  const model = {
    links: [link(IDENTITY, -1, -1), link([0, 0, 1, 1, 0, 0, 0], 0, 0), link([0, 0, 1, 1, 0, 0, 0], 0, 1)],
    // J is turned about y by a quarter: its z is the parent's x.
    joints: [joint('prismatic', 0, 1, [0, 0, 0, S, 0, S, 0], [0, 0, 2]), joint('screw', 0, 2, IDENTITY, [0, 0, 1], 0.5)],
  };
  const result = placed(model, { 1: [0.3], 2: [Math.PI] });
  near(result.at(1), [0.3, 0, 1, 1, 0, 0, 0]);
  near(result.at(2), [0, 0, 1.25, 0, 0, 0, 1]); // half a turn: half of 0.5 m
});

test('a ball keeps the joint where it is and takes the orientation as told', () => {
  const model = { links: [link(IDENTITY, -1, -1), link([1, 0, 0, 1, 0, 0, 0], 0, 0)], joints: [joint('ball', 0, 1, [-1, 0, 0, 1, 0, 0, 0], [0, 0, 1])] };
  // The base stands at (0, 0, 5) turned by a quarter; the child is turned by another in it: half a turn in the world.
  near(placed(model, { 1: [0, 0, 0, S, 0, 0, S] }, [0, 0, 5, S, 0, 0, S]).at(1), [-1, 0, 5, 0, 0, 0, 1]);
});

test('children may come before their parents', () => {
  const model = {
    links: [link(IDENTITY, -1, -1), link([2, 0, 0, 1, 0, 0, 0], 2, 0), link([1, 0, 0, 1, 0, 0, 0], 0, 1)],
    joints: [joint('fixed', 2, 1, IDENTITY, [0, 0, 1]), joint('continuous', 0, 2, IDENTITY, [0, 0, 1])],
  };
  // Link 2 at x = 1 turns in place; link 1, a metre before it, goes around.
  near(placed(model, { 2: [Math.PI / 2] }).at(1), [1, 1, 0, S, 0, 0, S]);
});

test('form 1 takes all poses as told; what is not finite changes nothing', () => {
  const model = { links: [link(IDENTITY, -1, -1), link(IDENTITY, 0, 0)], joints: [joint('revolute', 0, 1, IDENTITY, [0, 0, 1])] };
  const chain = new Chain(model);
  const slot = { motions: chain.motions, values: Float64Array.of(1, 2, 3, 1, 0, 0, 0, 4, 5, 6, 1, 0, 0, 0), form: 1 };
  const world = new Float64Array(14);
  const scratch = new Float64Array(100);
  assert.equal(chain.place(slot, world, scratch, IDENTITY), true);
  near(world, slot.values);
  for (const form of [0, 1]) {
    slot.form = form;
    slot.values[1] = NaN;
    assert.equal(chain.place(slot, world, scratch, IDENTITY), false);
    assert.equal(world[1], 2);
  }
});

test('a ring of links does not hang', () => {
  const model = { links: [link(IDENTITY, -1, -1), link(IDENTITY, 2, 0), link(IDENTITY, 1, 1)], joints: [joint('fixed', 2, 1, IDENTITY, [0, 0, 1]), joint('fixed', 1, 2, IDENTITY, [0, 0, 1])] };
  assert.equal(placed(model, {}).ok, true);
});
