import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { Assets, Between, Bodies, mixAngle, mixRecords, mixTurn, THREE, Way } = await load('../test/bodies_entry.ts');

const near = (a, b, tolerance = 1e-12) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const about_z = (rad) => [Math.cos(rad / 2), 0, 0, Math.sin(rad / 2)];

test('angles go the shorter way round', () => {
  near(mixAngle(1, 2, 0.25), 1.25);
  const over = mixAngle((350 * Math.PI) / 180, (10 * Math.PI) / 180, 0.75);
  near(Math.sin(over), Math.sin((5 * Math.PI) / 180));
  near(Math.cos(over), Math.cos((5 * Math.PI) / 180));
});

test('orientations turn at a constant rate, and the shorter way', () => {
  const out = new Float64Array(4);
  for (const f of [0, 0.2, 0.5, 1]) {
    mixTurn(Float64Array.from(about_z(0.3)), Float64Array.from(about_z(2.3)), 0, f, out);
    about_z(0.3 + 2 * f).forEach((x, i) => near(out[i], x));
    // The same orientation with the other sign.
    mixTurn(Float64Array.from(about_z(0.3)), Float64Array.from(about_z(2.3).map((x) => -x)), 0, f, out);
    about_z(0.3 + 2 * f).forEach((x, i) => near(Math.abs(out[i]), Math.abs(x)));
  }
  // Nearly alike, where an arc sine would lose its digits: still of length 1.
  mixTurn(Float64Array.from(about_z(0.3)), Float64Array.from(about_z(0.3 + 1e-7)), 0, 0.5, out);
  near(Math.hypot(...out), 1, 1e-15);
  near(2 * Math.atan2(out[3], out[0]), 0.3 + 0.5e-7, 1e-12);
});

test('each joint is mixed as it moves', () => {
  // Free, Fixed, Angle, Slide: numbers of Motion as in binary.ts.
  const motions = Uint8Array.of(5, 0, 1, 2);
  const a = new Float64Array(28), b = new Float64Array(28), out = new Float64Array(28);
  a.set([1, 2, 3, ...about_z(0)]);
  b.set([2, 4, 3, ...about_z(1)]);
  a[14] = 6.2, b[14] = 0.1; // over the full turn
  a[21] = 0.5, b[21] = 0.7;
  mixRecords(motions, 0, a, b, 0.5, out);
  [1.5, 3, 3, ...about_z(0.5)].forEach((x, i) => near(out[i], x));
  near(Math.sin(out[14]), Math.sin((6.2 + 0.1 + 2 * Math.PI) / 2));
  near(out[21], 0.6);
});

const record = (x, form = 0) => ({ motions: Uint8Array.of(5), form, values: Float64Array.from([x, 0, 0, 1, 0, 0, 0]) });

test('a way leads from what is shown to what was told', () => {
  const way = new Way(Uint8Array.of(5), 7);
  assert.equal(way.take(record(1), 1, true), false); // the first is shown at once
  assert.equal(way.take(record(2), 1.05, true), true);
  assert.equal(way.shown.values[0], 1);
  way.advance(0.25);
  near(way.shown.values[0], 1.25);
  near(way.shown_s, 1.0125);
  // The next one comes early: it goes on from there.
  assert.equal(way.take(record(3), 1.1, true), true);
  way.advance(0.5);
  near(way.shown.values[0], (1.25 + 3) / 2);
  way.advance(1);
  assert.equal(way.active, false);
  assert.equal(way.shown.values[0], 3);
  near(way.shown_s, 1.1);
});

test('what was put elsewhere, or has gone back in time, is there at once', () => {
  const way = new Way(Uint8Array.of(5), 7);
  way.take(record(0), 1, true);
  assert.equal(way.take(record(5.1), 1.05, true), false); // 50 m/s over two steps are 5 m
  assert.equal(way.shown.values[0], 5.1);
  assert.equal(way.take(record(5.2), 0.5, true), false);
  assert.equal(way.take(record(5.3), 0.55, true), true);
  assert.equal(way.take(record(5.4, 1), 0.6, true), false); // links instead of joints
  assert.equal(way.take(record(5.5, 1), 0.65, false), false);
  assert.equal(way.take(record(5.5, 1), 0.7, true), false); // it stands
  way.forget();
  assert.equal(way.take(record(5.6, 1), 0.75, true), false);
});

test('only slow messages of a run that plays are glided to', () => {
  const clock = new Between();
  assert.equal(clock.message(0), false);
  assert.equal(clock.message(500), false); // it stands still
  clock.pace(true, 500);
  for (let ms = 600; ms <= 900; ms += 33) assert.equal(clock.message(ms), false);
  // Slow motion begins: the second message has the new interval.
  assert.equal(clock.message(1400), true);
  near(clock.share(1400 + 125), 125 / 503);
  assert.equal(clock.message(1900), true);
  assert.equal(clock.share(9999), 1);
  clock.pace(false, 500);
  assert.equal(clock.share(1901), 1);
  clock.pace(true, 500);
  clock.message(2000);
  assert.equal(clock.message(2500), true);
  assert.equal(clock.message(6600), false);
  // Steps of 50 ms: what moves after 200 ms of rest is shown at once.
  clock.pace(true, 50);
  clock.message(7000);
  assert.equal(clock.message(7050), true);
  assert.equal(clock.message(7250), false);
});

const IDENTITY = [0, 0, 0, 1, 0, 0, 0];

test('a body that drives evenly is drawn evenly, one message late', () => {
  const bodies = new Bodies(new THREE.Group(), new Assets('/none', () => {}), () => {});
  const model = { id: 'a', name: 'a', static: false, links: [{ name: 'link', pose: IDENTITY, parent: -1, joint: -1, visuals: [], collisions: [] }], joints: [] };
  const instance = (id, name) => ({ id, name, original: '', model: 'a', robot: false, team: '', pose: IDENTITY, devices: [], controllers: [] });
  bodies.setWorld({ epoch: 1, revision: 1, lights: [], models: [model], instances: [instance(1, 'x'), instance(2, 'y')] });
  const [x, y] = [bodies.by_id.get(1), bodies.by_id.get(2)];
  const clock = new Between();
  clock.pace(true, 250);
  // Speed 0.2, steps of 50 ms: a message every 250 ms; 1 m/s, hence 0.2 m a second on the screen.
  const drawn = [];
  let message = 0;
  for (let ms = 0; ms < 2000; ms += 10) {
    if (ms >= 250 * message) {
      bodies.glide(clock.share(ms));
      const glides = clock.message(ms);
      bodies.restart();
      const told = [x, ...(message === 3 ? [y] : [])]; // y moves once, and no further message is of it
      for (const body of told) {
        body.values.set([0.05 * message, 0, 0, 1, 0, 0, 0]);
        assert.ok(bodies.take(body, 0.05 * message, glides));
      }
      message += 1;
    }
    bodies.glide(clock.share(ms));
    if (ms >= 500) drawn.push(x.world[0]);
  }
  for (let i = 1; i < drawn.length; ++i) near(drawn[i] - drawn[i - 1], 0.002, 1e-9);
  near(drawn[0], 0.05, 1e-9); // at 500 ms message 2 comes: 0.1 m, and 0.05 m is drawn
  near(x.way.shown_s, x.world[0], 1e-9);
  // A beam measured at the time of the message is drawn from where the sensor was then.
  const at = new Float64Array(7);
  x.devicePoseAt({ link: 0, pose: IDENTITY }, 0.35, at);
  near(at[0], 0.35, 1e-9);
  near(y.world[0], 0.15, 1e-9); // y was first told of: at once, and there it stays
});

test('a body that an early message does not tell of goes on from where it is', () => {
  const bodies = new Bodies(new THREE.Group(), new Assets('/none', () => {}), () => {});
  const model = { id: 'a', name: 'a', static: false, links: [{ name: 'link', pose: IDENTITY, parent: -1, joint: -1, visuals: [], collisions: [] }], joints: [] };
  const instance = { id: 1, name: 'x', original: '', model: 'a', robot: false, team: '', pose: IDENTITY, devices: [], controllers: [] };
  bodies.setWorld({ epoch: 1, revision: 1, lights: [], models: [model], instances: [instance] });
  const body = bodies.by_id.get(1);
  const clock = new Between();
  clock.pace(true, 200);
  const message = (ms, time_s, x) => {
    bodies.glide(clock.share(ms));
    const glides = clock.message(ms);
    bodies.restart();
    if (x === null) return;
    body.values.set([x, 0, 0, 1, 0, 0, 0]);
    bodies.take(body, time_s, glides);
  };
  message(0, 0, 0);
  message(200, 0.1, 0.1);
  message(360, 0.2, null); // at 0.8 of the way
  near(body.world[0], 0.08, 1e-12);
  let last = body.world[0];
  for (let ms = 370; ms < 600; ms += 10) {
    bodies.glide(clock.share(ms));
    assert.ok(body.world[0] >= last, `${body.world[0]} after ${last}`);
    last = body.world[0];
  }
  near(last, 0.1, 1e-12);
  assert.equal(bodies.glide(1), false);
});
