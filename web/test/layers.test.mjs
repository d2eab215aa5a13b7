import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';
import { CdrWriter } from '../mock/bytes.mjs';

const { ellipseOf, groundEllipse, spreadOf } = await load('scene/ellipse.ts');
const data = await load('app/layer_data.ts');
const { drawingOf, goalMessage, layerKindOf, placeOf, sameContent, startOf, thinned, toldOf, tooLong } = data;
const { goalInputs, inputName } = await load('app/goals.ts');
const { levelOf, onFirst } = await load('app/layers.ts');
const { decoderFor } = await load('net/decoders.ts');

const near = (actual, expected, tolerance = 1e-12) => assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} instead of ${expected}`);
/** A 6x6 covariance with that of the position in its corner. */
function covariance36(c, heading = 0) {
  const out = new Array(36).fill(0);
  for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) out[6 * i + k] = c[i][k];
  out[35] = heading;
  return out;
}
const diagonal = (x, y, z = 0) => [[x, 0, 0], [0, y, 0], [0, 0, z]];
const turned = (yaw) => [0, 0, 0, Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
const pitched = (pitch) => [0, 0, 0, Math.cos(pitch / 2), 0, Math.sin(pitch / 2), 0];
const pose = (x = 0, y = 0, z = 0, q = {}) => ({ position: { x, y, z }, orientation: { x: 0, y: 0, z: 0, w: 1, ...q } });
const header = (frame_id) => ({ stamp: { sec: 0, nanosec: 0 }, frame_id });

test('an ellipse has two standard deviations along its axes', () => {
  // Variances 0.25 along the diagonal and 0.01 across: turned by 45 degrees, (0.25 + 0.01) / 2 and (0.25 - 0.01) / 2.
  const diagonally = ellipseOf(0.13, 0.12, 0.13);
  near(diagonally.major_m, 2 * 0.5);
  near(diagonally.minor_m, 2 * 0.1, 1e-9);
  near(diagonally.turn_rad, Math.PI / 4);
  assert.deepEqual(ellipseOf(4, 0, 1), { major_m: 4, minor_m: 2, turn_rad: 0 });
  const upright = ellipseOf(1, 0, 4);
  assert.deepEqual([upright.major_m, upright.minor_m], [4, 2]);
  near(upright.turn_rad, Math.PI / 2);
  assert.deepEqual(ellipseOf(9, 0, 9), { major_m: 6, minor_m: 6, turn_rad: 0 });
  // A line: xx yy = xy^2. Its variance is the trace, its direction atan(1 / 2).
  const line = ellipseOf(4, 2, 1);
  near(line.major_m, 2 * Math.sqrt(5));
  near(line.minor_m, 0, 1e-7);
  near(line.turn_rad, Math.atan(0.5));
});

test('a covariance goes over into the frame of the world', () => {
  const of = (c, frame) => groundEllipse(c.flat(), frame);
  // Turned by 90 degrees: what was along x is along y.
  const quarter = of(diagonal(4, 1), turned(Math.PI / 2));
  near(quarter.major_m, 4);
  near(Math.abs(quarter.turn_rad), Math.PI / 2);
  // Turned by 30 degrees, so is the ellipse.
  near(of(diagonal(4, 1), turned(Math.PI / 6)).turn_rad, Math.PI / 6);
  // Pitched by 60 degrees: the world's x is cos x + sin z of the frame, with the variance 1/4 * 1 + 3/4 * 9 = 7; y stays.
  const steep = of(diagonal(1, 4, 9), pitched(Math.PI / 3));
  near(steep.major_m, 2 * Math.sqrt(7));
  near(steep.minor_m, 4);
  near(steep.turn_rad, 0);
});

test('a covariance that says nothing is told from one that is wrong', () => {
  const spread = (c) => spreadOf(covariance36(c));
  assert.deepEqual([...spread(diagonal(1, 2, 3)).covariance], [1, 0, 0, 0, 2, 0, 0, 0, 3]);
  assert.deepEqual(spread(diagonal(0, 0)), { covariance: null, why: '' });
  assert.match(spread(diagonal(NaN, 1)).why, /not finite/);
  assert.match(spread(diagonal(1, Infinity)).why, /not finite/);
  assert.match(spread([[1, NaN, 0], [0, 1, 0], [0, 0, 0]]).why, /not finite/);
  assert.match(spread(diagonal(-1, 1)).why, /negative/);
  assert.match(spread([[1, 2, 0], [2, 1, 0], [0, 0, 1]]).why, /depend/);
  assert.match(spreadOf([1, 2, 3]).why, /3 numbers/);
  // Two halves that differ, as rounding makes them: their mean.
  assert.equal(spread([[1, 0.2, 0], [0.4, 1, 0], [0, 0, 1]]).covariance[1].toFixed(12), '0.300000000000');
  // A height that is not estimated does not spoil the rest.
  assert.deepEqual([...spread([[1, 0, NaN], [0, 2, 0], [0, 0, NaN]]).covariance], [1, 0, 0, 0, 2, 0, 0, 0, 0]);
});

test('estimates are drawn whatever their covariance says, and it is said what is left out', () => {
  const estimate = (c, p = pose(1, 2)) => drawingOf('pose', { header: header('odom'), pose: { pose: p, covariance: c } });
  const good = estimate(covariance36([[0.13, 0.12, 0], [0.12, 0.13, 0], [0, 0, 0]], 0.04));
  assert.equal(good.info, '± 1.00 m');
  assert.equal(good.note, '');
  near(good.drawing.heading_rad, 0.4);
  assert.deepEqual([...good.drawing.pose], [1, 2, 0, 1, 0, 0, 0]);
  const nan = estimate(covariance36(diagonal(NaN, 1), NaN));
  assert.equal(nan.drawing.covariance, null);
  assert.equal(nan.drawing.heading_rad, 0);
  assert.equal(nan.info, 'no ellipse');
  assert.match(nan.note, /^Drawn without an ellipse: its covariance is not finite/);
  assert.equal(estimate(covariance36(diagonal(0, 0))).note, '');
  const lost = estimate(covariance36(diagonal(1e6, 1e6)));
  assert.deepEqual([lost.info, lost.drawing.covariance], ['unsure', null]);
  assert.match(estimate(covariance36(diagonal(1, 1)), pose(NaN)).note, /not finite/);
  assert.equal(estimate(covariance36(diagonal(1, 1)), pose(NaN)).drawing, null);
  assert.equal(drawingOf('pose', undefined).drawing, null);
  // No orientation: not turned. A quaternion of another length: normalised.
  assert.deepEqual([...estimate(covariance36(diagonal(1, 1)), pose(0, 0, 0, { w: 0 })).drawing.pose.slice(3)], [1, 0, 0, 0]);
  assert.deepEqual([...estimate(covariance36(diagonal(1, 1)), pose(0, 0, 0, { w: 2 })).drawing.pose.slice(3)], [1, 0, 0, 0]);
});

const map = (width, height, cells, more = {}) => ({ header: header('map'), info: { resolution: 0.05, width, height, origin: pose(-1, -2), ...more }, data: cells });

test('a map becomes bytes: unknown above 100, the rest as it is', () => {
  const { drawing, info, note } = drawingOf('map', map(3, 2, Int8Array.of(-1, 0, 1, 50, 99, 100)));
  assert.deepEqual([...drawing.cells], [255, 0, 1, 50, 99, 100]);
  assert.deepEqual([drawing.width, drawing.height, drawing.resolution_m], [3, 2, 0.05]);
  assert.deepEqual([...drawing.origin], [-1, -2, 0, 1, 0, 0, 0]);
  assert.equal(info, '3 × 2, 5.0 cm');
  assert.equal(note, '');
  assert.deepEqual([...drawingOf('map', map(2, 1, [-1, 100])).drawing.cells], [255, 100]);
});

test('a map that cannot be drawn says why', () => {
  const why = (value, ...rest) => {
    const made = drawingOf('map', value, ...rest);
    assert.equal(made.drawing, null);
    return made.note;
  };
  assert.match(why(map(0, 0, new Int8Array(0))), /0 × 0 cells/);
  assert.match(why(map(4, 0, new Int8Array(0))), /4 × 0 cells/);
  assert.match(why(map(3, 3, new Int8Array(8))), /8 cells for 3 × 3/);
  assert.match(why(map(2, 2, new Int8Array(4), { resolution: NaN })), /NaN/);
  assert.match(why(map(2, 2, new Int8Array(4), { resolution: 0 })), /0 m/);
  assert.match(why(map(2, 2, new Int8Array(4), { resolution: -1 })), /-1 m/);
  assert.match(why(map(2, 2, new Int8Array(4), { origin: pose(Infinity) })), /origin/);
  // More than there is memory for: refused by its size, before anything is made of it.
  assert.match(why(map(100_000, 10_000, new Int8Array(0))), /4 million/);
  assert.match(why(map(5000, 1, new Int8Array(5000)), 4096), /4096/);
  assert.match(why({}), /no map/);
  assert.match(tooLong('map', 1e9), /1000.0 MB/);
  assert.equal(tooLong('map', 1_000_200), null);
});

test('a map is read from the bytes of its message', () => {
  const TIME = `\n${'='.repeat(80)}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n`;
  const of = (name, body) => `\n${'='.repeat(80)}\nMSG: ${name}\n${body}`;
  const schema = `std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n${of('std_msgs/Header', 'builtin_interfaces/Time stamp\nstring frame_id\n')}${TIME}`
    + of('nav_msgs/MapMetaData', 'builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin\n')
    + of('geometry_msgs/Pose', 'geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n')
    + of('geometry_msgs/Point', 'float64 x\nfloat64 y\nfloat64 z\n') + of('geometry_msgs/Quaternion', 'float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n');
  const w = new CdrWriter().time(1.5).string('map').time(0).f32(0.5).u32(2).u32(2);
  for (const v of [10, 20, 0, 0, 0, 0, 1]) w.f64(v);
  w.u32(4);
  for (const v of [255, 0, 42, 100]) w.u8(v);
  const decode = decoderFor({ id: 1, topic: '/rover/mapper/map', encoding: 'cdr', schemaName: 'nav_msgs/msg/OccupancyGrid', schemaEncoding: 'ros2msg', schema });
  const bytes = new Uint8Array(w.buffer());
  const { drawing, note } = drawingOf('map', decode(bytes));
  assert.equal(note, '');
  assert.deepEqual([...drawing.cells], [255, 0, 42, 100]);
  assert.deepEqual([...drawing.origin], [10, 20, 0, 1, 0, 0, 0]);
  // The same a second later says nothing new; another cell does, wherever the bytes lie.
  const later = new Uint8Array(bytes.length + 3).subarray(3);
  later.set(bytes);
  later[4] += 1;
  assert.equal(sameContent(bytes, later), true);
  later[later.length - 1] = 0;
  assert.equal(sameContent(bytes, later), false);
  assert.equal(sameContent(null, bytes), false);
  assert.equal(sameContent(bytes, bytes.subarray(0, -1)), false);
});

test('plans and particles without what is not finite, and thinned where they are many', () => {
  const path = (poses) => drawingOf('path', { header: header('map'), poses: poses.map((p) => ({ header: header('map'), pose: p })) });
  const plan = path([pose(0), pose(NaN), pose(2)]);
  assert.deepEqual([...plan.drawing.poses].filter((_, i) => i % 7 === 0), [0, 2]);
  assert.equal(plan.note, '1 of them is not finite and left out');
  assert.equal(plan.info, '3 poses');
  assert.equal(path([pose(1)]).info, '1 pose');
  assert.deepEqual([path([]).drawing.poses.length, path([]).info], [0, '0 poses']);
  const long = path(Array.from({ length: data.poses_max + 1 }, (_, i) => pose(i)));
  assert.equal(long.drawing.poses[long.drawing.poses.length - 7], data.poses_max, 'its end is kept');
  assert.match(long.note, /5001 of 10001 poses are drawn/);
  assert.deepEqual(thinned([0, 1, 2, 3, 4, 5, 6], 4), [0, 2, 4, 6]);
  assert.deepEqual(thinned([0, 1, 2, 3, 4, 5], 4), [0, 2, 4, 5]);
  const cloud = drawingOf('particles', { header: header('map'), poses: [pose(0), pose(0, Infinity), pose(1, NaN)] });
  assert.equal(cloud.drawing.poses.length, 7);
  assert.equal(cloud.note, '2 of them are not finite and left out');
  const many = drawingOf('particles', { poses: Array.from({ length: data.particles_max + 1 }, () => pose(1)) });
  assert.ok(many.drawing.poses.length / 7 <= data.particles_max);
  assert.match(many.note, /2501 of 5001 particles are drawn/);
});

test('types are known with and without msg', () => {
  assert.deepEqual(['nav_msgs/msg/OccupancyGrid', 'nav_msgs/Path', 'geometry_msgs/msg/PoseArray', 'nav_msgs/msg/Odometry', 'geometry_msgs/msg/PoseWithCovarianceStamped', 'geometry_msgs/msg/PoseStamped'].map(layerKindOf),
    ['map', 'path', 'particles', 'pose', 'pose', null]);
});

test('frames lie where they begin, where a body is, or where a program says', () => {
  const owner = { name: 'rover', start: [1, 2, 0, 1, 0, 0, 0] };
  const bodies = (frame) => frame === 'rover/base';
  assert.equal(placeOf('', owner, bodies, []), 'world');
  assert.equal(placeOf('world', owner, bodies, []), 'world');
  assert.equal(placeOf('rover/base', owner, bodies, ['map'], true), 'body');
  assert.equal(placeOf('rover/odom', owner, bodies, []), 'start');
  assert.equal(placeOf('rover/odom', owner, bodies, ['map']), 'start');
  assert.equal(placeOf('odom', owner, bodies, [], true), 'told');
  assert.equal(placeOf('map', owner, bodies, ['map']), 'world');
  assert.equal(placeOf('map', owner, bodies, []), 'start', 'a filter with a receiver counts from where it began');
  assert.equal(placeOf('rover/map', owner, bodies, ['map', 'pose']), 'start', 'a cost map where a filter of its own believes the robot to be');
  assert.equal(placeOf('rover/map', owner, bodies, ['map', 'particles']), 'world', 'particles are in a map of the world');
  assert.equal(placeOf('rover2/map', owner, bodies, ['map']), 'world');
  assert.equal(placeOf('map', null, bodies, []), 'world');
  // Upright, though the robot stood on a slope; turned as it stood.
  const start = [1, 2, 3, Math.cos(0.25), 0, Math.sin(0.25), 0];
  assert.deepEqual([...startOf(start, undefined)], [1, 2, 3, 1, 0, 0, 0]);
  assert.deepEqual([...startOf(start, undefined, true)], start);
  assert.deepEqual([...startOf([0, 0, 0, ...turned(1).slice(3)], [1, 0, 0, 1, 0, 0, 0])].map((v) => v.toFixed(9)), [Math.cos(1), Math.sin(1), 0, Math.cos(0.5), 0, 0, Math.sin(0.5)].map((v) => v.toFixed(9)));
});

test('what a transform tells', () => {
  const transform = (x, w = 1) => ({ translation: { x, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w } });
  const told = toldOf({ header: header('map'), child_frame_id: 'odom', transform: transform(2) });
  assert.deepEqual([told.parent, told.child, ...told.pose], ['map', 'odom', 2, 0, 0, 1, 0, 0, 0]);
  for (const bad of [undefined, {}, { header: header(''), child_frame_id: 'odom', transform: transform(0) }, { header: header('map'), child_frame_id: 'map', transform: transform(0) },
    { header: header('map'), child_frame_id: 'odom', transform: transform(NaN) }]) assert.equal(toldOf(bad), null);
});

test('a goal goes over into the frame that the robot knows', () => {
  // A frame at (1, 2), turned to the left: the world's y is its x.
  const frame = Float64Array.of(1, 2, ...turned(Math.PI / 2).slice(2));
  const goal = goalMessage('geometry_msgs/msg/PoseStamped', 'map', frame, [1, 5, 0], Math.PI / 2, 12.25);
  assert.deepEqual(goal.header, { stamp: { sec: 12, nanosec: 250000000 }, frame_id: 'map' });
  near(goal.pose.position.x, 3, 1e-9);
  near(goal.pose.position.y, 0, 1e-9);
  near(goal.pose.orientation.z, 0, 1e-9);
  near(goal.pose.orientation.w, 1, 1e-9);
  const first = goalMessage('geometry_msgs/msg/PoseWithCovarianceStamped', 'map', frame, [1, 5, 0], Math.PI, 0);
  near(first.pose.pose.orientation.z, Math.SQRT1_2, 1e-9);
  assert.equal(first.pose.covariance.length, 36);
  assert.deepEqual([first.pose.covariance[0], first.pose.covariance[7], first.pose.covariance[8]], [0.25, 0.25, 0]);
  near(first.pose.covariance[35], (Math.PI / 12) ** 2, 1e-6);
});

test('a robot is told what programs of its own and its team read while they run', () => {
  const program = (path, inputs, more = {}) => ({ name: path.split('/')[1], path, kind: 'x', inputs, ...more });
  const goal = (name) => ({ name, type: 'geometry_msgs/msg/PoseStamped' });
  const first = { name: '/ann/initialpose', type: 'geometry_msgs/msg/PoseWithCovarianceStamped' };
  const world = {
    instances: [
      { name: 'ann', robot: true, team: 'red', controllers: [program('ann/localiser', [first]), program('ann/navigator', [goal('/ann/goal_pose')]), program('ann/guard', [goal('/ann/goal_pose'), { name: '/ann/word', type: 'std_msgs/msg/String' }])] },
      { name: 'bob', robot: true, team: '', controllers: [program('bob/navigator', [goal('/bob/goal_pose')], { inactive: true }), program('bob/wander')] },
      { name: 'wall', robot: false, team: '', controllers: [] },
    ],
    teams: [{ name: 'red', programs: [program('red/coach', [goal('/red/goal_pose')])] }],
  };
  assert.deepEqual(goalInputs(world, 'ann').map((i) => [i.topic, i.programs, inputName(i, 'ann')]), [
    ['/ann/goal_pose', ['ann/navigator', 'ann/guard'], 'goal_pose'], ['/red/goal_pose', ['red/coach'], '/red/goal_pose'], ['/ann/initialpose', ['ann/localiser'], 'initialpose']]);
  assert.deepEqual(goalInputs(world, 'bob'), []);
  assert.deepEqual(goalInputs(world, 'wall'), []);
  assert.deepEqual(goalInputs(null, 'ann'), []);
});

test('levels of devices that do not measure are no layers', () => {
  const rover = { name: 'rover', devices: [{ path: 'rover/gps', active: ['fix'], topics: [{ name: '/rover/gps/fix', type: 'x', level: 'fix' }, { name: '/rover/gps/pose', type: 'x', level: 'pose' }, { name: '/rover/gps/any', type: 'x', level: '' }] }] };
  assert.deepEqual(['/rover/gps/fix', '/rover/gps/pose', '/rover/gps/any', '/rover/estimator/odometry'].map((topic) => levelOf(rover, topic)), ['active', 'inactive', 'active', null]);
  assert.equal(levelOf(undefined, '/rover/gps/fix'), null);
  assert.deepEqual([onFirst('pose', true), onFirst('pose', false), onFirst('map', true)], [false, true, true]);
});
