import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const m = await load('app/match.ts');
const { newsOf } = await load('ui/score_board.ts');

const decision = (sequence, time_s, rule = 'throw_in', more = {}) => m.decisionOf({
  header: { stamp: { sec: Math.floor(time_s), nanosec: Math.round((time_s % 1) * 1e9) } }, sequence, tick: Math.round(time_s * 100), rule, team: 'cyan', ...more,
});
const near = (a, b, tolerance = 1e-6) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

test('messages are read as CDR and as JSON give them, and whatever is missing is nothing', () => {
  const players = [{ name: 'cyan1', team: 'cyan', number: 1, x: -8, y: 0.5, yaw: 1 }];
  const cdr = decision(7n, 12.5, 'goal', { tick: 1250n, score: new Uint32Array([1, 2]), point: { x: 9, y: 0, z: 0 }, ball: { x: 9.1, y: 0.2, z: 0.1 }, players });
  const json = decision('7', 12.5, 'goal', { tick: '1250', score: [1, 2], point: { x: 9, y: 0, z: 0 }, ball: { x: 9.1, y: 0.2, z: 0.1 }, players });
  assert.deepEqual(cdr, json);
  assert.equal(cdr.time_s, 12.5);
  assert.deepEqual([cdr.sequence, cdr.tick, cdr.score, cdr.ball, cdr.players[0].at], [7, 1250, [1, 2], [9.1, 0.2], [-8, 0.5]]);
  for (const bad of [undefined, null, 3, 'x', [], { players: 5, score: 'x', ball: null, header: 1 }]) {
    assert.deepEqual([m.decisionOf(bad).players, m.decisionOf(bad).ball, m.gameOf(bad).teams, m.gameOf(bad).stage], [[], [0, 0], [], '']);
  }
  assert.equal(m.gameOf({ clock: Infinity }).clock_s, 0);
  assert.equal(m.playerOf({ ball_confidence: 7 }).ball_confidence, 1);
});

test('words and clocks as people read them', () => {
  assert.equal(m.wordsOf('throw_in'), 'Throw-in');
  assert.equal(m.wordsOf('own_goal'), 'Own goal');
  assert.equal(m.clockText(187.999), '3:07');
  assert.equal(m.clockText(-1), '0:00');
  assert.equal(m.titleOf(decision(1, 0, 'goal', { score: [1, 0] })), 'Goal: cyan (1 : 0)');
  assert.equal(m.titleOf(decision(1, 0, 'corner', { score: [1, 0] })), 'Corner: cyan');
  assert.deepEqual(['goal', 'own_goal', 'second_yellow', 'half_time', 'corner', 'in_play'].map((rule) => m.weightOf(decision(1, 0, rule))), ['goal', 'goal', 'card', 'stage', 'call', 'minor']);
  assert.equal(m.reasonOf({ robot: 'cyan2', reason: 'is too near to the ball' }), 'cyan2: is too near to the ball');
  assert.equal(m.reasonOf({ robot: 'cyan2', reason: 'cyan2 touched it last' }), 'cyan2 touched it last');
  const state = (more) => newsOf({ stage: 'first_half', phase: 'running', set_piece: '', team: '', in_play: true, ...more });
  assert.equal(state({}), 'In play');
  assert.equal(state({ phase: 'preparing', set_piece: 'throw_in', team: 'magenta', in_play: false }), 'Throw-in, magenta · preparing');
  assert.equal(state({ set_piece: 'corner', team: 'cyan', in_play: false }), 'Corner, cyan · ball is to be played');
  assert.equal(state({ phase: 'stopped', in_play: false }), 'Stopped');
  assert.equal(state({ stage: 'ended' }), 'The game is over');
});

test('the log knows what comes again, and forgets a course that was left', () => {
  const book = new m.DecisionBook();
  book.set([decision(2, 4), decision(1, 3)]);
  assert.deepEqual(book.list.map((d) => d.sequence), [1, 2]);
  assert.equal(book.add(decision(2, 4)), false);
  assert.equal(book.add(decision(3, 9, 'goal')), true);
  assert.deepEqual(book.between(3.5, 9).map((d) => d.sequence), [2, 3]);
  assert.equal(book.add(decision(2, 4.5, 'corner')), true);
  assert.deepEqual(book.list.map((d) => [d.sequence, d.rule]), [[1, 'throw_in'], [2, 'corner']]);
});

test('a field is known by its goals', () => {
  const goals = (x) => [{ name: 'goal_cyan', pose: [-x, 0, 0] }, { name: 'goal_magenta', pose: [x, 0, 0] }, { name: 'goalkeeper', pose: [40, 0, 0] }];
  assert.equal(m.lengthOfField(goals(9)), 18);
  assert.equal(m.lengthOfField(goals(9).slice(0, 1)), 0);
  assert.equal(m.dimensionsOf(18).width, 12);
  assert.equal(m.dimensionsOf(12.3).width, 8);
  assert.equal(m.dimensionsOf(0).length, 22);
  near(m.dimensionsOf(44).width, 28);
});

test('heat is time, by place', () => {
  const tally = new m.Tally(m.dimensionsOf(12));
  for (let i = 0; i <= 10; i++) tally.sample(i * 0.2, [3.1, -1.9], [{ name: 'a1', team: 'a', at: [-2, 1] }, { name: 'a2', team: 'a', at: [4, 1] }]);
  const ball = tally.heat('ball'), team = tally.heat('a');
  near(ball.values.reduce((a, b) => a + b), 2, 1e-4);
  near(team.values.reduce((a, b) => a + b), 4, 1e-4);
  near(tally.seconds, 2, 1e-9);
  // The cell of (3.1, -1.9): 9.1 m from the left end and 5.9 m from the upper side in cells of 0.5 m, one behind the margin; a quarter of the time is its own.
  near(ball.values[(11 + 1) * ball.columns + 18 + 1], 2 / 4, 1e-4);
  // What comes later goes into grids that are there already; what is far outside is nowhere, and a gap of a minute counts a second.
  tally.sample(2.2, [100, 100], []);
  tally.sample(62.2, [3.1, -1.9], []);
  near(ball.values.reduce((a, b) => a + b), 3, 1e-4);
  // Back in time.
  tally.sample(1.1, [0, 0], []);
  near(tally.heat('ball').values.reduce((a, b) => a + b), 1.1, 1e-4);
});

test('a pass is two touches within a team, the ball having moved', () => {
  const team = (robot) => robot[0];
  const tally = new m.Tally(m.dimensionsOf(12));
  const robots = [{ name: 'a1', team: 'a', at: [0, 0] }, { name: 'a2', team: 'a', at: [4, 0] }, { name: 'b1', team: 'b', at: [4, 3] }];
  const play = (time_s, ball, touched, in_play = true) => {
    tally.sample(time_s, ball, robots);
    tally.touch(time_s, touched, in_play, team);
  };
  play(1, [0.3, 0], 'a1');
  play(2, [0.5, 0.1], 'a1');
  play(2.5, [2, 0.1], 'a1');   // on its way: the pass begins where a1 had it
  play(3, [3.7, 0], 'a2');
  assert.deepEqual(tally.passes.map((p) => [p.from, p.to, p.begin, p.end]), [['a1', 'a2', [0.5, 0.1], [3.7, 0]]]);
  play(4, [3.8, 2.7], 'b1');   // lost
  play(5, [3.9, 0.1], 'a2');   // won
  assert.equal(tally.passes.length, 1);
  play(6, [3.9, 0.2], 'a1');   // the ball has not moved
  assert.equal(tally.passes.length, 1);
  play(7, [3.9, 0.2], 'a1', false);
  play(8, [0, 0], 'a2');       // after a restart nobody has passed
  assert.equal(tally.passes.length, 1);
  tally.forgetAfter(2.9);
  assert.equal(tally.passes.length, 0);
});

test('who comes late makes the same maps of what the server has kept', () => {
  const team = (robot) => robot[0];
  const live = new m.Tally(m.dimensionsOf(12)), late = new m.Tally(m.dimensionsOf(12));
  const track = { robots: ['a1', 'a2', 'b1'], teams: ['a', 'a', 'b'], times: [], places: [], touch_times: [], touches: [] };
  const absent = -2147483648;
  const holders = [[0, 'a1'], [2, 'a2'], [4, 'b1'], [6, 'b1'], [8, '']];
  let holder = '';
  for (let i = 0; i < 50; i++) {
    const time_s = i * 0.2, now = holders.filter(([from_s]) => from_s <= time_s).at(-1)[1];
    // a1 gives it to a2, who loses it; b1 comes after a second.
    const spots = [[0, 0], [4, 0.25], [4, 3]], ball = [Math.min(4000, 200 * i) / 1000, time_s > 4 ? 2.5 : 0.125];
    if (now !== '') {
      const robots = track.robots.map((name, r) => ({ name, team: name[0], at: spots[r] })).filter((r) => r.name !== 'b1' || time_s >= 1);
      live.sample(time_s, ball, robots);
      track.times.push(time_s);
      track.places.push(...ball.map((v) => Math.round(1000 * v)), 0, 0, 4000, 250, ...(time_s >= 1 ? [4000, 3000] : [absent, absent]));
    }
    live.touch(time_s, now, now !== '', team);
    if (now !== holder) {
      track.touch_times.push(time_s);
      track.touches.push(now);
      holder = now;
    }
  }
  assert.deepEqual(live.passes.map((p) => [p.from, p.to]), [['a1', 'a2']]);
  late.sample(3, [5, 5], []);  // what it has seen itself is part of what the server has
  late.load(m.trackOf(track));
  assert.deepEqual(late.passes, live.passes);
  for (const key of ['ball', 'a', 'b']) assert.deepEqual(late.heat(key).values, live.heat(key).values);
  near(late.seconds, live.seconds);
  near(late.heat('b').values.reduce((a, b) => a + b), 7, 0.21);
  assert.equal(late.latest_s, live.latest_s);
  // What is cut off, or no track at all, is as much as there is.
  assert.equal(m.trackOf({ ...track, places: track.places.slice(0, 20) }).times.length, 2);
  for (const bad of [null, 3, {}, { robots: 'x', times: [1, 2], places: 7, touches: 1, touch_times: [1] }]) assert.deepEqual([m.trackOf(bad).times, m.trackOf(bad).touches], [[], []]);
});

test('near a mark the pointer is at the mark, rather at a goal', () => {
  const marks = [{ time_s: 10, weight: 'call' }, { time_s: 10.6, weight: 'goal' }, { time_s: 30, weight: 'minor' }];
  assert.equal(m.markNear(marks, 10.1, 1).time_s, 10.6);
  assert.equal(m.markNear(marks, 9.2, 1).time_s, 10);
  assert.equal(m.markNear(marks, 29.5, 1).time_s, 30);
  assert.equal(m.markNear(marks, 20, 1), null);
});
