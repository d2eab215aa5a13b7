// A made-up world for the mock server: a hall with a floor, walls, boxes, a mesh, and rovers that drive circles.
// Poses follow from the time alone, so that a jump needs no history.
import { Writer, smallestThree } from './bytes.mjs';

const IDENTITY = [0, 0, 0, 1, 0, 0, 0];
const WHEEL_RADIUS_M = 0.08;
const HALF_TRACK_M = 0.19;
/** A turn by a quarter about x: the axis of a cylinder, z, becomes -y. */
const ON_ITS_SIDE = [Math.SQRT1_2, -Math.SQRT1_2, 0, 0];

const grey = (v, a = 1) => [v, v, v, a];
const paint = (diffuse, more = {}) => ({ diffuse, specular: grey(0.1), emissive: [0, 0, 0, 1], shininess: 0, texture: '', from_mesh: false, ...more });
const visual = (name, pose, shape, material) => ({ name, pose, shape, material, cast_shadows: true });
const link = (name, pose, parent, joint, visuals, collisions = visuals.map(({ name: n, pose: p, shape }) => ({ name: n, pose: p, shape }))) =>
  ({ name, pose, parent, joint, visuals, collisions, lights: [] });
const single = (id, name, is_static, visuals) => ({ id, name, static: is_static, links: [link('link', IDENTITY, -1, -1, visuals)], joints: [] });

function roverModel(id, color) {
  const wheel = (name, y, joint) => link(name, [0, y, WHEEL_RADIUS_M, ...ON_ITS_SIDE], 0, joint, [
    visual('tyre', IDENTITY, { type: 'cylinder', radius: WHEEL_RADIUS_M, length: 0.045 }, paint(grey(0.12))),
    visual('hub', IDENTITY, { type: 'cylinder', radius: 0.045, length: 0.05 }, paint(grey(0.75))),
    visual('spoke', IDENTITY, { type: 'box', size: [0.13, 0.018, 0.052] }, paint(grey(0.3))),
  ]);
  const caster_radius_m = 0.03;
  return {
    id, name: 'rover', static: false,
    links: [
      link('base_link', IDENTITY, -1, -1, [
        visual('deck', [0, 0, 0.12, 1, 0, 0, 0], { type: 'box', size: [0.44, 0.31, 0.09] }, paint(color)),
        visual('cover', [-0.05, 0, 0.185, 1, 0, 0, 0], { type: 'box', size: [0.26, 0.24, 0.04] }, paint(grey(0.22))),
        visual('bumper', [0.225, 0, 0.1, 1, 0, 0, 0], { type: 'box', size: [0.03, 0.27, 0.04] }, paint(grey(0.18))),
        visual('lidar', [0.1, 0, 0.235, 1, 0, 0, 0], { type: 'cylinder', radius: 0.05, length: 0.06 }, paint(grey(0.1))),
        visual('lidar window', [0.1, 0, 0.24, 1, 0, 0, 0], { type: 'cylinder', radius: 0.051, length: 0.02 }, paint([0.1, 0.35, 0.5, 1])),
        visual('left lamp', [0.222, 0.11, 0.14, 1, 0, 0, 0], { type: 'sphere', radius: 0.022 }, paint([1, 0.95, 0.8, 1], { emissive: [0.6, 0.55, 0.4, 1] })),
        visual('right lamp', [0.222, -0.11, 0.14, 1, 0, 0, 0], { type: 'sphere', radius: 0.022 }, paint([1, 0.95, 0.8, 1], { emissive: [0.6, 0.55, 0.4, 1] })),
      ]),
      wheel('left_wheel', HALF_TRACK_M, 0),
      wheel('right_wheel', -HALF_TRACK_M, 1),
      link('caster', [-0.17, 0, caster_radius_m, 1, 0, 0, 0], 0, 2, [visual('ball', IDENTITY, { type: 'sphere', radius: caster_radius_m }, paint(grey(0.4)))]),
    ],
    joints: [
      { name: 'left_wheel', type: 'continuous', parent: 0, child: 1, pose: IDENTITY, axis: [0, 0, 1], lower: null, upper: null, thread_pitch_m: 0 },
      { name: 'right_wheel', type: 'continuous', parent: 0, child: 2, pose: IDENTITY, axis: [0, 0, 1], lower: null, upper: null, thread_pitch_m: 0 },
      { name: 'caster', type: 'ball', parent: 0, child: 3, pose: IDENTITY, axis: [0, 0, 1], lower: null, upper: null, thread_pitch_m: 0 },
    ],
  };
}

const TEAMS = ['red', 'blue', ''];
const HALF_ROOM_M = 6;

export function makeWorld(robots) {
  const crowd = robots > 12;
  const half_m = crowd ? Math.ceil(Math.sqrt(robots)) * 0.9 + 2 : HALF_ROOM_M;
  const brick = paint([0.82, 0.8, 0.76, 1]);
  const wall = (name, x, y, size) => visual(name, [x, y, size[2] / 2, 1, 0, 0, 0], { type: 'box', size }, brick);
  const models = [
    single('m0', 'floor', true, [visual('plane', IDENTITY, { type: 'plane', normal: [0, 0, 1] }, paint([0.72, 0.73, 0.75, 1]))]),
    single('m1', 'walls', true, [
      wall('north', 0, half_m, [2 * half_m + 0.2, 0.2, 0.7]),
      wall('south', 0, -half_m, [2 * half_m + 0.2, 0.2, 0.7]),
      wall('east', half_m, 0, [0.2, 2 * half_m - 0.2, 0.7]),
      wall('west', -half_m, 0, [0.2, 2 * half_m - 0.2, 0.7]),
    ]),
    single('m2', 'crate', false, [visual('box', IDENTITY, { type: 'box', size: [0.5, 0.5, 0.5] }, paint(grey(1), { texture: 't0' }))]),
    single('m3', 'rock', false, [visual('mesh', IDENTITY, { type: 'mesh', mesh: 'a0' }, paint(grey(1), { from_mesh: true }))]),
    single('m4', 'ball', false, [visual('ball', IDENTITY, { type: 'sphere', radius: 0.15 }, paint([0.95, 0.5, 0.1, 1]))]),
    single('m5', 'pillar', true, [visual('pillar', [0, 0, 0.6, 1, 0, 0, 0], { type: 'cylinder', radius: 0.2, length: 1.2 }, paint([0.55, 0.6, 0.66, 1]))]),
    single('m6', 'cone', false, [visual('cone', [0, 0, 0.17, 1, 0, 0, 0], { type: 'cone', radius: 0.12, length: 0.34 }, paint([0.95, 0.35, 0.05, 1])),
      visual('foot', [0, 0, 0.01, 1, 0, 0, 0], { type: 'box', size: [0.3, 0.3, 0.02] }, paint(grey(0.15)))]),
    single('m7', 'glass', true, [visual('pane', [0, 0, 0.4, 1, 0, 0, 0], { type: 'box', size: [0.03, 1.6, 0.8] }, paint([0.5, 0.75, 0.85, 0.35]))]),
    single('m8', 'hill', true, [visual('terrain', IDENTITY, { type: 'heightmap', grid: 'g0' }, paint([0.45, 0.55, 0.35, 1]))]),
    single('m9', 'broken', true, [visual('mesh', IDENTITY, { type: 'mesh', mesh: 'a404' }, paint(grey(0.5)))]),
    roverModel('m10', [0.85, 0.2, 0.17, 1]),
    roverModel('m11', [0.13, 0.42, 0.78, 1]),
    roverModel('m12', [0.93, 0.68, 0.13, 1]),
  ];
  const bodies = [];
  let next_id = 1;
  const put = (name, model, x, y, z = 0, yaw = 0) => {
    const pose = [x, y, z, Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
    const body = { id: next_id++, name, original: models[+model.slice(1)].name, model, robot: false, team: '', pose, devices: [], controllers: [] };
    bodies.push(body);
    return body;
  };
  put('floor', 'm0', 0, 0);
  put('walls', 'm1', 0, 0);
  put('crate', 'm2', 3, 2, 0.25, 0.3);
  put('crate_2', 'm2', 3.1, 2.7, 0.25, -0.2);
  put('crate_3', 'm2', 3.05, 2.35, 0.75, 0.1);
  put('rock', 'm3', -3.2, 2.4, 0.3);
  put('ball', 'm4', 1, -4, 0.15);
  put('pillar', 'm5', -4, -3.6);
  for (let i = 0; i < 4; ++i) put(`cone_${i + 1}`, 'm6', -1.5 + i, 4.6);
  put('glass', 'm7', 4.6, -1);
  put('hill', 'm8', -half_m - 6, 0, -0.02);
  put('broken', 'm9', -4.6, 4.6, 0.1);
  for (let i = 0; i < robots; ++i) {
    const name = i === 0 ? 'rover' : `rover_${i + 1}`;
    const body = put(name, `m${10 + (i % 3)}`, 0, 0);
    const side = Math.ceil(Math.sqrt(robots));
    Object.assign(body, { robot: true, team: TEAMS[i % 3], original: 'Rover' });
    body.circle = crowd
      ? { x: ((i % side) - (side - 1) / 2) * 1.8, y: (Math.floor(i / side) - (side - 1) / 2) * 1.8, radius: 0.5, rate: 0.5 + (i % 7) * 0.08, phase: i }
      : { x: [0, -0.5, 1][i % 3], y: [0, 0.5, -1][i % 3], radius: 1.2 + 1.15 * i, rate: 0.42 / (1 + 0.4 * i), phase: i * 2.1 };
    const scan = `/${name}/laser/ranges`;
    body.devices = [
      { name: 'laser', path: `${name}/laser`, kind: 'laser_scanner', link: 0, pose: [0.1, 0, 0.24, 1, 0, 0, 0], active: ['ranges'],
        topics: [{ name: scan, type: 'sensor_msgs/msg/LaserScan', level: 'ranges' }], commands: [] },
      { name: 'camera', path: `${name}/camera`, kind: 'camera', link: 0, pose: [0.23, 0, 0.16, 1, 0, 0, 0], active: [], topics: [], commands: [] },
      { name: 'ideal', path: `${name}/drive/ideal`, kind: 'ideal_drive', link: 0, pose: IDENTITY, active: ['ideal'], topics: [],
        commands: [{ name: `/${name}/drive/ideal/command`, type: 'geometry_msgs/msg/Twist', level: 'ideal' }] },
      { name: 'battery', path: `${name}/battery`, kind: 'battery', link: 0, pose: IDENTITY, active: [], topics: [], commands: [] },
    ];
    body.controllers = [{ name: 'controller', path: `${name}/controller`, kind: 'wander' }];
  }
  const field = (path, type, unit, help, min, max, value, more = {}) => ({ path, type, unit, help, min, max, tunable: true, default: value, choices: [], length: 0, ...more });
  const level = (name, message, command, help) => ({ name, message, command, help });
  const kinds = {
    laser_scanner: { help: 'Scans a plane with beams.', levels: [level('ranges', 'sensor_msgs/msg/LaserScan', '', 'Distances.')],
      fields: [field('rate', 'number', 'Hz', 'Scans per second.', 0.001, 1000, '10', { tunable: false }),
        field('noise/white', 'number', 'm', 'Standard deviation of each range.', 0, 1, '0.01')] },
    camera: { help: 'Takes pictures.', levels: [], fields: [] },
    battery: { help: 'Stores energy.', levels: [], fields: [] },
    ideal_drive: { help: 'Moves the robot as told.', levels: [level('ideal', '', 'geometry_msgs/msg/Twist', 'Speeds.')],
      fields: [field('max_speed', 'number', 'm/s', 'Fastest.', 0, 10, '1')] },
    wander: { help: 'Drives about and avoids walls.', levels: [],
      fields: [field('speed', 'number', 'm/s', 'Speed when nothing is near.', 0, 2, '0.5'),
        field('turn', 'string', '', 'Side to turn to.', null, null, 'left', { choices: ['left', 'right'] }),
        field('avoid', 'boolean', '', 'Turn away from walls.', null, null, 'true')] },
    'media/wind': { help: 'Air that moves everywhere with one velocity.', levels: [],
      fields: [field('density', 'number', 'kg/m^3', 'Density of the air.', 0, 100000, '1.225')] },
    'media/shout': { help: 'Words that carry as far as they are loud.', levels: [],
      fields: [field('threshold', 'number', 'dB', 'Level below which nothing is heard.', -200, 300, '30')] },
    'rules/goals': { help: 'Counts how often an object comes into markers.', levels: [], fields: [] },
    formation: { help: 'Drives the robots of a team to places in a formation.', levels: [],
      fields: [field('spacing', 'number', 'm', 'Distance between neighbours.', 0.001, 10000, '1')] },
  };
  return {
    bodies,
    half_m,
    json: {
      revision: 1, epoch: 1, name: 'mock hall', engine: 'mock', step_s: 0.01, seed: 1, gravity: [0, 0, -9.81],
      ambient: [0.4, 0.4, 0.4, 1], background: [0.7, 0.7, 0.7, 1],
      lights: [{ type: 'directional', name: 'sun', pose: [0, 0, 10, 0.9239, 0.2, -0.3, 0.1], color: [0.9, 0.9, 0.88, 1], cast_shadows: true,
        range_m: 0, constant: 1, linear: 0, quadratic: 0, inner_rad: 0, outer_rad: 0 }],
      media: [{ name: 'breeze', path: 'media/breeze', kind: 'wind' }, { name: 'air', path: 'media/air', kind: 'shout' }],
      rules: [{ name: 'goals', path: 'rules/goals', kind: 'goals' }],
      criteria: TEAMS.filter((team) => team !== '').map((team) => ({ team, address: `${team}.criterion`, value: 'rules/goals.scored' })),
      teams: [{ name: 'red', programs: [{ name: 'coach', path: 'red/coach', kind: 'formation' }] }],
      models,
      instances: bodies.map(({ circle: _, ...rest }) => rest),
      kinds,
    },
  };
}

/** Position of a rover at a time, with the yaw along its circle. */
export function driven(body, time_s) {
  const c = body.circle;
  const angle = c.phase + c.rate * time_s;
  return { x: c.x + c.radius * Math.cos(angle), y: c.y + c.radius * Math.sin(angle), yaw: angle + Math.PI / 2, turned: c.rate * time_s, radius: c.radius };
}

/** A message of /sandlot/poses; `only` undefined: a key frame of all that can move. */
export function posesMessage(world, tick, only) {
  const static_models = new Set(world.json.models.filter((m) => m.static).map((m) => m.id));
  const told = world.bodies.filter((b) => !static_models.has(b.model) && (only === undefined || only.has(b.id)));
  const time_s = tick * world.json.step_s;
  const w = new Writer();
  w.u8(1).u8(only === undefined ? 1 : 0).u16(world.json.epoch).u32(world.json.revision).u64(BigInt(tick)).i64(BigInt(Math.round(time_s * 1e9))).u32(told.length);
  for (const body of told) {
    w.u32(body.id).u8(0);
    if (body.circle === undefined) {
      w.f32(body.pose[0]).f32(body.pose[1]).f32(body.pose[2]).bytes(smallestThree(body.pose.slice(3)));
      continue;
    }
    const at = driven(body, time_s);
    w.f32(at.x).f32(at.y).f32(0).bytes(smallestThree([Math.cos(at.yaw / 2), 0, 0, Math.sin(at.yaw / 2)]));
    for (const side of [-1, 1]) {
      const angle = (at.turned * (at.radius + side * HALF_TRACK_M)) / WHEEL_RADIUS_M / (2 * Math.PI);
      w.u16(Math.floor((angle - Math.floor(angle)) * 65536) & 0xffff);
    }
    const roll = (at.turned * at.radius) / 0.03;
    w.bytes(smallestThree([Math.cos(roll / 2), 0, Math.sin(roll / 2), 0]));
  }
  return w.arrayBuffer();
}

/** Distances from a laser to the four walls and the pillar: enough for the eye. */
export function scan(world, body, time_s, beams) {
  const at = body.circle ? driven(body, time_s) : { x: body.pose[0], y: body.pose[1], yaw: 0 };
  const x = at.x + 0.1 * Math.cos(at.yaw);
  const y = at.y + 0.1 * Math.sin(at.yaw);
  const inside_m = world.half_m - 0.1;
  const ranges = new Float32Array(beams);
  for (let i = 0; i < beams; ++i) {
    const angle = at.yaw - 2.0944 + (4.1888 * i) / (beams - 1);
    const dx = Math.cos(angle);
    const dy = Math.sin(angle);
    let nearest = Math.min(dx > 0 ? (inside_m - x) / dx : dx < 0 ? (-inside_m - x) / dx : Infinity, dy > 0 ? (inside_m - y) / dy : dy < 0 ? (-inside_m - y) / dy : Infinity);
    for (const [cx, cy, radius] of [[-4, -3.6, 0.2], [3, 2, 0.3], [3.1, 2.7, 0.3], [1, -4, 0.15]]) {
      const along = (cx - x) * dx + (cy - y) * dy;
      const aside2 = (cx - x) ** 2 + (cy - y) ** 2 - along * along;
      if (along > 0 && aside2 < radius * radius) nearest = Math.min(nearest, along - Math.sqrt(radius * radius - aside2));
    }
    ranges[i] = nearest > 8 ? Infinity : nearest + (Math.random() - 0.5) * 0.02;
  }
  return ranges;
}

/** A rock: an icosahedron subdivided once and roughened; the upper half in another colour. */
export function rockMesh() {
  const p = (1 + Math.sqrt(5)) / 2;
  const points = [[-1, p, 0], [1, p, 0], [-1, -p, 0], [1, -p, 0], [0, -1, p], [0, 1, p], [0, -1, -p], [0, 1, -p], [p, 0, -1], [p, 0, 1], [-p, 0, -1], [-p, 0, 1]];
  let faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]];
  const middle = new Map();
  const half = (a, b) => {
    const key = a < b ? `${a},${b}` : `${b},${a}`;
    if (!middle.has(key)) middle.set(key, points.push(points[a].map((c, i) => (c + points[b][i]) / 2)) - 1);
    return middle.get(key);
  };
  faces = faces.flatMap(([a, b, c]) => { const ab = half(a, b), bc = half(b, c), ca = half(c, a); return [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]; });
  const at = points.map((q, i) => { const s = (0.38 + 0.05 * Math.sin(i * 12.9)) / Math.hypot(...q); return [q[0] * s, q[1] * s * 1.2, q[2] * s * 0.8]; });
  const height = (f) => at[f[0]][2] + at[f[1]][2] + at[f[2]][2];
  faces.sort((a, b) => height(a) - height(b));
  const lower = faces.filter((f) => height(f) < 0).length;
  const w = new Writer().u32(0x314d4c53).u32(at.length).u32(faces.length).u32(0).u32(2);
  at.forEach((q) => q.forEach((c) => w.f32(c)));
  faces.forEach((f) => f.forEach((i) => w.u32(i)));
  w.u32(0).u32(lower).f32(0.35).f32(0.31).f32(0.28).f32(1).u32(0);
  w.u32(lower).u32(faces.length - lower).f32(0.5).f32(0.5).f32(0.46).f32(1).u32(0);
  return w.buffer();
}

export function hillGrid() {
  const n = 48;
  const w = new Writer().u32(0x31474c53).u32(n).u32(n).f32(10).f32(10);
  for (let row = 0; row < n; ++row) {
    for (let column = 0; column < n; ++column) {
      const x = (column / (n - 1)) * 2 - 1;
      const y = (row / (n - 1)) * 2 - 1;
      const edge = Math.max(0, 1 - x * x) * Math.max(0, 1 - y * y);
      w.f32(edge * (0.8 + 0.35 * Math.sin(5 * x + 1) * Math.cos(4 * y)));
    }
  }
  return w.buffer();
}
