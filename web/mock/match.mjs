// A made-up match of two teams for the mock server: places, score and decisions follow from the time alone, so that a jump needs no history.
import { CdrWriter } from './bytes.mjs';
import { makeWorld } from './world.mjs';

const IDENTITY = [0, 0, 0, 1, 0, 0, 0];
const HALF_S = 900, PASS_S = 2.5, LENGTH_M = 18, WIDTH_M = 12;
const ROLES = ['goalkeeper', 'defender', 'supporter', 'striker', 'winger'];
const paint = (r, g, b) => ({ diffuse: [r, g, b, 1], specular: [0.1, 0.1, 0.1, 1], emissive: [0, 0, 0, 1], shininess: 0, texture: '', from_mesh: false });
const visual = (name, pose, shape, material) => ({ name, pose, shape, material, cast_shadows: true });
const model = (id, name, is_static, visuals) => ({
  id, name, static: is_static, joints: [],
  links: [{ name: 'link', pose: IDENTITY, parent: -1, joint: -1, visuals, collisions: [], lights: [] }],
});
const box = (name, x, y, z, size, material) => visual(name, [x, y, z, 1, 0, 0, 0], { type: 'box', size }, material);

function fieldModel() {
  const white = paint(0.95, 0.95, 0.95), [l, w] = [LENGTH_M / 2, WIDTH_M / 2];
  const frame = (name, x, depth, width) => [box(`${name} a`, x, 0, 0.004, [0.125, width, 0.004], white), ...[-1, 1].map((s) => box(`${name} ${s}`, x + (Math.sign(x) * depth) / 2, (s * width) / 2, 0.004, [depth, 0.125, 0.004], white))];
  return model('m0', 'field', true, [
    box('carpet', 0, 0, -0.01, [LENGTH_M + 4, WIDTH_M + 3, 0.02], paint(0.1, 0.42, 0.2)), box('middle', 0, 0, 0.004, [0.125, WIDTH_M, 0.004], white),
    ...[-1, 1].flatMap((s) => [box(`side ${s}`, 0, s * w, 0.004, [LENGTH_M, 0.125, 0.004], white), box(`end ${s}`, s * l, 0, 0.004, [0.125, WIDTH_M, 0.004], white),
      ...frame(`penalty ${s}`, s * (l - 2.25), 2.25, 6.5), ...frame(`goal area ${s}`, s * (l - 0.75), 0.75, 3.5)]),
    visual('spot', [0, 0, 0.004, 1, 0, 0, 0], { type: 'cylinder', radius: 0.1, length: 0.004 }, white),
  ]);
}
const goalModel = (id, color) => model(id, 'goal', true, [...[-1, 1].map((s) => box(`post ${s}`, 0, s, 0.5, [0.1, 0.1, 1], color)), box('bar', 0, 0, 1, [0.1, 2.1, 0.1], color), box('back', 0.6, 0, 0.5, [0.04, 2, 1], paint(0.8, 0.8, 0.8))]);
const robotModel = (id, color) => model(id, 'msl_robot', false, [
  visual('base', [0, 0, 0.14, 1, 0, 0, 0], { type: 'cylinder', radius: 0.25, length: 0.22 }, paint(0.13, 0.13, 0.14)), visual('band', [0, 0, 0.32, 1, 0, 0, 0], { type: 'cylinder', radius: 0.2, length: 0.14 }, color),
  visual('tower', [0, 0, 0.55, 1, 0, 0, 0], { type: 'cylinder', radius: 0.07, length: 0.34 }, paint(0.2, 0.2, 0.22)), box('kicker', 0.24, 0, 0.12, [0.06, 0.16, 0.1], paint(0.7, 0.7, 0.72)),
]);

export function makeMatch() {
  const world = makeWorld(0);
  const models = [fieldModel(), goalModel('m1', paint(0.1, 0.7, 0.8)), goalModel('m2', paint(0.85, 0.1, 0.6)), robotModel('m3', paint(0.1, 0.7, 0.8)), robotModel('m4', paint(0.85, 0.1, 0.6)),
    model('m5', 'ball', false, [visual('ball', IDENTITY, { type: 'sphere', radius: 0.11 }, paint(0.95, 0.45, 0.05))])];
  const bodies = [];
  const put = (name, of, pose, more = {}) => bodies.push({ id: bodies.length + 1, name, original: name, model: of, robot: false, team: '', pose, devices: [], controllers: [], ...more });
  put('field', 'm0', IDENTITY);
  put('goal_cyan', 'm1', [-LENGTH_M / 2, 0, 0, 0, 0, 0, 1]);
  put('goal_magenta', 'm2', [LENGTH_M / 2, 0, 0, 1, 0, 0, 0]);
  put('ball', 'm5', [0, 0, 0.11, 1, 0, 0, 0]);
  for (const team of ['cyan', 'magenta']) {
    for (let n = 1; n <= 5; ++n) {
      const name = `${team}${n}`;
      put(name, team === 'cyan' ? 'm3' : 'm4', [0, 0, 0, 1, 0, 0, 0], { robot: true, team, controllers: [{ name: 'player', path: `${name}/player`, kind: 'soccer_player' }] });
    }
  }
  Object.assign(world.json, { name: 'mock match', models, instances: bodies, media: [], criteria: ['cyan', 'magenta'].map((team) => ({ team, address: `${team}.criterion`, value: '' })),
    rules: [{ name: 'referee', path: 'rules/referee', kind: 'referee' }], teams: [] });
  Object.assign(world, { bodies, half_m: LENGTH_M / 2 });
  moveMatch(world, 0);
  return world;
}

const PLACES = [[-8.6, 0], [-4.8, 2.2], [-1.6, -2.9], [1.8, 1.1], [0.4, 4]];
function robotAt(team, n, time_s) {
  const side = team === 'cyan' ? 1 : -1, [x, y] = PLACES[n - 1];
  const reach = n === 1 ? 0.15 : 1, phase = n * 1.7 + side;
  return { x: side * (x + reach * 1.6 * Math.sin(0.21 * time_s + phase)), y: side * (y * 0.9 + (n === 1 ? 0.7 : 1.3) * Math.sin(0.33 * time_s + 2 * phase)), yaw: (side > 0 ? 0 : Math.PI) + 0.5 * Math.sin(0.4 * time_s + phase) };
}

/** Who has the ball in the k-th pass of the game. */
function holder(k) {
  const team = Math.floor(k / 4) % 2 === 0 ? 'cyan' : 'magenta';
  return { team, n: 2 + ((k * 7 + Math.floor(k / 4)) % 4) };
}
const nameOf = ({ team, n }) => `${team}${n}`;
function nearBall({ team, n }, time_s) {
  const at = robotAt(team, n, time_s);
  return [at.x + 0.33 * Math.cos(at.yaw), at.y + 0.33 * Math.sin(at.yaw)];
}
/** The first 1.2 s with the robot, then on its way to the next one. */
function ballAt(time_s) {
  const k = Math.floor(time_s / PASS_S), within_s = time_s - k * PASS_S;
  const part = Math.max(0, (within_s - 1.2) / (PASS_S - 1.2));
  const [a, b] = [nearBall(holder(k), time_s), nearBall(holder(k + 1), time_s)];
  return [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])];
}

export function moveMatch(world, time_s) {
  for (const body of world.bodies) {
    if (body.name === 'ball') {
      const [x, y] = ballAt(time_s);
      body.pose = [x, y, 0.11, 1, 0, 0, 0];
    } else if (body.robot) {
      const at = robotAt(body.team, Number(body.name.at(-1)), time_s);
      body.pose = [at.x, at.y, 0, Math.cos(at.yaw / 2), 0, 0, Math.sin(at.yaw / 2)];
    }
  }
}

// at, rule, team, robot, command, reason, point
const SCRIPT = [
  [0.5, 'begin', 'cyan', '', 'KICKOFF', 'the game begins; cyan has the kick-off', [0, 0]],
  [3, 'start', 'cyan', '', 'START', 'all robots are where they may be', [0, 0]],
  [4, 'in_play', 'cyan', 'cyan4', '', 'the ball has moved 0.2 m', [0, 0]],
  [11, 'throw_in', 'magenta', 'cyan3', 'THROWIN', 'the ball left the field over the side line; cyan3 touched it last', [3.4, -6]],
  [18, 'goal', 'cyan', 'cyan4', 'GOAL', 'the whole ball is behind the goal line of magenta; cyan4 touched it last', [9, 0.4]],
  [20, 'kickoff', 'magenta', '', 'KICKOFF', 'after a goal of cyan', [0, 0]],
  [29, 'pushing', 'cyan', 'magenta3', 'FREEKICK', 'magenta3 pushed cyan4 with 14 Ns', [4.1, 1.8]],
  [29.2, 'yellow_card', 'magenta', 'magenta3', 'YELLOW_CARD', 'the third foul by pushing of magenta3', [4.1, 1.8]],
  [38, 'corner', 'magenta', 'cyan1', 'CORNER', 'the ball left the field behind the goal line of cyan; cyan1 touched it last', [-9, 6]],
  [44, 'goal', 'magenta', 'magenta4', 'GOAL', 'the whole ball is behind the goal line of cyan; magenta4 touched it last', [-9, -0.5]],
  [46, 'kickoff', 'cyan', '', 'KICKOFF', 'after a goal of magenta', [0, 0]],
  [57, 'goal_area', 'cyan', 'magenta4', 'FREEKICK', 'magenta4 stood in the goal area of cyan for 3 s', [-7.5, 1]],
  [66, 'goal', 'cyan', 'cyan5', 'GOAL', 'the whole ball is behind the goal line of magenta; cyan5 touched it last', [9, -0.2]],
];

/** As JSON of the messages, and `at_s`. */
export function decisionsUntil(world, time_s) {
  const score = [0, 0];
  return SCRIPT.filter(([at_s]) => at_s <= time_s).map(([at_s, rule, team, robot, command, reason, point], i) => {
    if (rule === 'goal') ++score[team === 'cyan' ? 0 : 1];
    const [x, y] = rule === 'goal' || rule === 'corner' || rule === 'throw_in' ? point : ballAt(at_s);
    const players = world.bodies.filter((b) => b.robot).map((b) => ({ name: b.name, team: b.team, number: Number(b.name.at(-1)), ...robotAt(b.team, Number(b.name.at(-1)), at_s) }));
    const sec = Math.floor(at_s);
    return { at_s, header: { stamp: { sec, nanosec: Math.round((at_s - sec) * 1e9) }, frame_id: '' }, sequence: i + 1, tick: Math.round(at_s * 100), stage: 'first_half', clock: Math.max(0, at_s - 3), rule,
      command, team, robot, reason, point: { x: point[0], y: point[1], z: 0 }, ball: { x, y, z: 0.11 }, score: [...score], players };
  });
}

const vector = (w, v) => w.f64(v.x).f64(v.y).f64(v.z ?? 0);
export function decisionMessage(d) {
  const w = new CdrWriter().time(d.at_s).string('').u64(d.sequence).u64(d.tick).string(d.stage).f64(d.clock).string(d.rule).string(d.command).string(d.team).string(d.robot).string(d.reason);
  vector(vector(w, d.point), d.ball).u32(2);
  d.score.forEach((s) => w.u32(s));
  w.u32(d.players.length);
  for (const p of d.players) w.string(p.name).string(p.team).i32(p.number).f64(p.x).f64(p.y).f64(p.yaw);
  return w.buffer();
}

/** @param wrong  what a robot might hold to be true: the page should not show it */
export function stateMessage(time_s, wrong = false) {
  const before = SCRIPT.filter(([at_s]) => at_s <= time_s), last = before.at(-1);
  const goals = (team) => before.filter(([, rule, of]) => rule === 'goal' && of === team).length;
  const piece = { begin: 'kickoff', kickoff: 'kickoff', throw_in: 'throw_in', corner: 'corner', pushing: 'free_kick', yellow_card: 'free_kick', goal_area: 'free_kick', start: 'kickoff', goal: '' }[last?.[1]] ?? '';
  const since_s = last ? time_s - last[0] : 0, waits = since_s < (last?.[1] === 'goal' ? 2 : 1);
  const w = new CdrWriter().time(time_s).string('').string('first_half').string(last?.[1] === 'goal' || !last ? 'stopped' : waits ? 'preparing' : 'running').string(waits ? piece : '')
    .string(waits && piece !== '' ? (last[1] === 'yellow_card' ? 'cyan' : last[2]) : '').bool(!waits).f64(Math.max(0, time_s - 3)).f64(HALF_S - Math.max(0, time_s - 3)).u32(2);
  for (const [i, team] of ['cyan', 'magenta'].entries()) {
    w.string(team).string(i === 0 ? 'Tidal' : 'Ember').u32(wrong ? 9 : goals(team)).u32(5).u32(before.filter(([, rule, of]) => rule === 'yellow_card' && of === team).length).u32(0).bool(i === 0)
      .f64(time_s * (i === 0 ? 0.56 : 0.38));
  }
  const k = Math.floor(time_s / PASS_S);
  return w.string(nameOf(holder(k))).u64(before.length).u64(before.length).buffer();
}

const waits = (time_s) => {
  const last = SCRIPT.filter(([at_s]) => at_s <= time_s).at(-1);
  return time_s - (last?.[0] ?? time_s) < (last?.[1] === 'goal' ? 2 : 1);
};
/** What a server keeps of a match: places and touches while the ball was in play. */
export function trackUntil(world, time_s) {
  const robots = world.bodies.filter((b) => b.robot && b.team), track = { robots: robots.map((b) => b.name), teams: robots.map((b) => b.team), times: [], places: [], touch_times: [], touches: [] };
  const mm = (m) => Math.round(1000 * m);
  for (let i = 0; i * 0.2 <= time_s; ++i) {
    const at_s = i * 0.2, robot = waits(at_s) ? '' : nameOf(holder(Math.floor(at_s / PASS_S)));
    if (robot !== (track.touches.at(-1) ?? '')) {
      track.touch_times.push(at_s);
      track.touches.push(robot);
    }
    if (robot === '') continue;
    track.times.push(at_s);
    track.places.push(...ballAt(at_s).map(mm), ...robots.flatMap((b) => {
      const { x, y } = robotAt(b.team, Number(b.name.at(-1)), at_s);
      return [mm(x), mm(y)];
    }));
  }
  return track;
}

export function playerMessage(world, body, time_s) {
  const n = Number(body.name.at(-1)), k = Math.floor(time_s / PASS_S), has = nameOf(holder(k)) === body.name;
  const at = robotAt(body.team, n, time_s), [x, y] = ballAt(time_s);
  const w = new CdrWriter().time(time_s).string('').i32(n).string(ROLES[n - 1]).string(has ? 'pass' : n === 1 ? 'guard_goal' : ['mark', 'support', 'go_to_ball', 'get_open'][n - 2]);
  vector(w, { x: at.x, y: at.y }).f64(0.05);
  for (const v of [{ x: 0, y: 0 }, { x: at.x, y: at.y }, { x, y }, { x: 0, y: 0 }]) vector(w, v);
  return w.f64(Math.max(0, 1 - Math.hypot(at.x - x, at.y - y) / 14)).bool(has).u32(0).f64(0.9).buffer();
}
