import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const forms = await load('ui/forms.ts');
const { rowsOf } = await load('ui/tree_rows.ts');
const { layoutGraph } = await load('ui/graph_layout.ts');
const { Actions, keyOf, keyLabel } = await load('app/actions.ts');
const format = await load('app/format.ts');
const { handsOfKeys, twistMessage, driveOf } = await load('ui/teleop.ts');
const { spanOf } = await load('ui/timeline.ts');
const { commonStart, completeLine } = await load('ui/console.ts');
const { Meter } = await load('ui/topics.ts');
const { graphOf } = await load('ui/graph.ts');
const { echoRows } = await load('ui/echo.ts');
const { dragLine } = await load('app/drags.ts');
const { score } = await load('ui/palette.ts');
const { Store, worldParts } = await load('app/store.ts');

const field = (more) => ({ path: 'noise/white', type: 'number', unit: 'm', help: '', min: 0, max: 1, tunable: true, default: '0', choices: [], length: 0, ...more });
const view = (more) => forms.fieldViews('rover/laser', [field(more)])[0];

test('a field becomes a control with its parameter', () => {
  assert.equal(view().address, 'rover/laser.noise.white');
  assert.equal(view().group, 'noise');
  assert.equal(view({ type: 'bool' }).control, 'switch');
  assert.equal(view({ type: 'choice', choices: ['a', 'b'] }).control, 'choice');
  assert.equal(view({ type: 'list of number' }).control, 'vector');
  assert.deepEqual(view().slider, { min: 0, max: 1, step: 0.01 });
  assert.equal(view({ max: 1e6 }).slider, null);
  assert.equal(view({ min: null }).slider, null);
  assert.deepEqual(view({ type: 'integer', max: 10 }).slider, { min: 0, max: 10, step: 1 });
});

test('what is typed is read with units and held to its range', () => {
  assert.deepEqual(forms.readField(view(), '5 cm'), { value: 0.05 });
  assert.deepEqual(forms.readField(view(), '2'), { error: 'at most 1' });
  assert.deepEqual(forms.readField(view(), '-1'), { error: 'at least 0' });
  assert.deepEqual(forms.readField(view(), 'x'), { error: 'not a number' });
  assert.deepEqual(forms.readField(view({ type: 'integer', max: 9 }), '1.5'), { error: 'not a whole number' });
  assert.deepEqual(forms.readField(view({ type: 'list of number', min: null, max: null, length: 3 }), '[1, -2 3]'), { value: [1, -2, 3] });
  assert.deepEqual(forms.readField(view({ type: 'list of number', length: 3 }), '1, 0'), { error: '3 numbers' });
  assert.ok(forms.isDefault(view(), 0) && !forms.isDefault(view(), 0.1));
  assert.equal(forms.writeField(0.1 + 0.2), '0.3');
});

const world = {
  revision: 1, epoch: 1, name: 'w', kinds: {},
  models: [{ id: 'm1', name: 'rover', static: false }, { id: 'm2', name: 'wall', static: true }],
  instances: [
    { id: 1, name: 'ann', original: 'ann', model: 'm1', robot: true, team: 'red', devices: [{ name: 'laser', path: 'ann/laser', kind: 'laser_scanner', active: [], topics: [], commands: [] }], controllers: [{ name: 'c', path: 'ann/c', kind: 'wander' }] },
    { id: 2, name: 'bob', original: 'bob', model: 'm1', robot: true, team: 'blue', devices: [], controllers: [] },
    { id: 3, name: 'wall', original: 'wall', model: 'm2', robot: false, team: '', devices: [], controllers: [] },
  ],
};
const keys = (rows) => rows.map((r) => r.key);

test('the tree folds, opens and finds', () => {
  assert.deepEqual(keys(rowsOf(world, new Set(), '')), ['group:robots', 'ann', 'bob', 'group:static', 'wall']);
  assert.deepEqual(keys(rowsOf(world, new Set(['ann', '-group:static']), '')), ['group:robots', 'ann', 'ann/laser', 'ann/c', 'bob', 'group:static']);
  assert.deepEqual(keys(rowsOf(world, new Set(), 'laser')), ['group:robots', 'ann', 'ann/laser']);
  assert.deepEqual(keys(rowsOf(world, new Set(), 'blue')), ['group:robots', 'bob']);
  assert.deepEqual(rowsOf(world, new Set(), 'zzz'), []);
  assert.equal(rowsOf(world, new Set(), 'ann')[0].detail, '1 of 2');
});

test('media, rules and programs of teams are found, have no place in the scene and are listed', () => {
  const store = new Store();
  const air = { name: 'air', path: 'media/air', kind: 'shout' }, coach = { name: 'coach', path: 'red/coach', kind: 'formation' };
  store.setWorld({ ...structuredClone(world), media: [air], teams: [{ name: 'red', programs: [coach] }] });
  store.select('media/air');
  assert.deepEqual(store.selected(), { address: 'media/air', instance: null, device: null, part: air });
  store.select('red/coach');
  assert.equal(store.selected().part.kind, 'formation');
  assert.equal(store.find('ann/c').instance.name, 'ann');
  assert.deepEqual(worldParts(store.world).map(({ title, parts }) => [title, parts.length]), [['Media', 1], ['Rules', 0], ['Teams', 1]]);
  store.setWorld(structuredClone(world));
  assert.equal(store.selection, null, 'it is gone');
});

test('a thousand robots make their rows within a frame many times over', () => {
  const instances = Array.from({ length: 1000 }, (_, i) => ({ ...world.instances[0], id: i, name: `r${i}` }));
  assert.equal(rowsOf({ ...world, instances }, new Set(), '').length, 1001);
  assert.equal(rowsOf({ ...world, instances }, new Set(), 'r99').length, 12);  // r99, r990 to r999, and the heading
});

test('the store finds things by address and drops a selection that is gone', () => {
  const store = new Store();
  store.setWorld(structuredClone(world));
  store.select('ann/laser');
  assert.equal(store.selected().device.kind, 'laser_scanner');
  store.select('nobody');
  assert.equal(store.selection, null);
  store.select('bob');
  store.setWorld({ ...structuredClone(world), instances: [world.instances[0]] });
  assert.equal(store.selection, null);
  let epochs = 0;
  store.onEpoch.on(() => epochs++);
  store.setWorld({ ...structuredClone(world), epoch: 2 });
  assert.equal(epochs, 1);
  assert.match(store.whyNotSteer(), /Not connected/);
  store.setRole('spectator');
  assert.match(store.whyNotSteer(), /watching/);
  store.setRole('admin');
  assert.equal(store.whyNotSteer(), null);
});

test('the graph flows in layers, also with a cycle, and nothing overlaps', () => {
  const nodes = ['a', 't', 'b', 'c'].map((id) => ({ id, width: 50 }));
  const { places } = layoutGraph(nodes, [['a', 't'], ['t', 'b'], ['b', 'c'], ['c', 'a'], ['a', 'a'], ['x', 'a']]);
  assert.deepEqual(['a', 't', 'b', 'c'].map((id) => places.get(id).layer), [0, 1, 2, 3]);
  const crossed = layoutGraph(['a', 'b', 'x', 'y'].map((id) => ({ id, width: 10 })), [['a', 'y'], ['b', 'x']]).places;
  assert.equal(crossed.get('a').y < crossed.get('b').y, crossed.get('y').y < crossed.get('x').y);
  const many = layoutGraph(Array.from({ length: 300 }, (_, i) => ({ id: `${i}`, width: 20 })), Array.from({ length: 299 }, (_, i) => [`${i}`, `${(i * 7 + 1) % 300}`]));
  const taken = new Set([...many.places.values()].map((p) => `${p.x} ${p.y}`));
  assert.equal(taken.size, 300);
});

test('keys: one action each, those that steer are refused with the reason', () => {
  let reason = 'You are watching';
  const said = [];
  let ran = 0;
  const actions = new Actions(() => reason, (text) => said.push(text));
  actions.add({ id: 'a', title: 'Step', group: 'Time', keys: ['.'], steers: true, run: () => ran++ }, { id: 'b', title: 'Grid', group: 'View', keys: ['g'], run: () => ran++ });
  assert.throws(() => actions.add({ id: 'c', title: '', group: 'View', keys: ['g'], run: () => undefined }), /two actions/);
  assert.ok(actions.press('.') && actions.press('g') && !actions.press('q'));
  assert.deepEqual([ran, said], [1, ['You are watching']]);
  reason = null;
  actions.press('.');
  assert.equal(ran, 2);
  assert.equal(actions.titleOf('a'), 'Step (.)');
  assert.equal(keyOf({ key: 'K', ctrlKey: true, metaKey: false, altKey: false }), 'ctrl+k');
  assert.equal(keyOf({ key: ' ', ctrlKey: false, metaKey: false, altKey: false }), 'space');
  assert.equal(keyOf({ key: 'Shift', ctrlKey: false, metaKey: false, altKey: false }), null);
  assert.deepEqual([keyLabel('ctrl+k'), keyLabel('+'), keyLabel('space')], ['Ctrl K', '+', 'Space']);
});

test('the table of keys holds those that the manual promises, each once', async () => {
  const { actionTable } = await load('app/tables.ts');
  const actions = new Actions(() => null, () => undefined);
  actions.add(...actionTable({}));  // throws if two share a key
  for (const key of ['space', '.', 'r', '1', '2', '3', '4', '5', '6', '7', 'f', 'h', 'g', 't', 'n', 'm', 'p', 'x', '/', '`', 'ctrl+k', 'escape']) assert.ok(actions.press(key), key);
  for (const key of ['w', 'a', 's', 'd', 'q', 'e']) assert.ok(!actions.press(key), `${key} is for driving`);
});

test('numbers and times as people read and write them', () => {
  assert.deepEqual([0, 0.1 + 0.2, 1234567, 1e9, 1e-9, NaN, Infinity].map((v) => format.formatNumber(v)), ['0', '0.3', '1234567', '1000000000', '1e-9', '–', '∞']);
  assert.equal(format.formatNumber(123456.789), '123456.8');
  assert.deepEqual([0, 59.994, 59.996, 3725.5].map(format.formatTime), ['0.00 s', '59.99 s', '1:00.00', '1:02:05.50']);
  assert.equal(format.formatFixed(-0.0001, 3), '0.000');
  assert.deepEqual(['90 deg', '5 cm', '.5', '1e-3', '', '1,5', '0x10', 'Infinity'].map(format.parseNumber), [Math.PI / 2, 0.05, 0.5, 0.001, null, null, null, null]);
  assert.deepEqual(['rover', 'a b', 'a"b'].map(format.word), ['rover', '"a b"', `'a"b'`]);
});

test('driving: keys add up, the command goes to the active level', () => {
  assert.deepEqual(handsOfKeys(['w', 'arrowup', 'a']), { forward: 1, left: 0, turn: 1 });
  assert.deepEqual(handsOfKeys(['w', 's']), { forward: 0, left: 0, turn: 0 });
  assert.deepEqual(twistMessage('geometry_msgs/msg/Twist', { forward: -1, left: 0, turn: 0.5 }, 0.4, 2, 0), { linear: { x: -0.4, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 1 } });
  const stamped = twistMessage('geometry_msgs/msg/TwistStamped', { forward: 1, left: 0, turn: 0 }, 1, 1, 2.25);
  assert.deepEqual(stamped.header.stamp, { sec: 2, nanosec: 250000000 });
  const commands = [{ name: '/r/d/wheels', type: 'geometry_msgs/msg/Twist', level: 'wheels' }, { name: '/r/d/ideal', type: 'geometry_msgs/msg/Twist', level: 'ideal' }];
  assert.equal(driveOf({ devices: [{ active: ['ideal'], commands }] }).topic, '/r/d/ideal');
  assert.equal(driveOf({ devices: [{ active: [], commands: [{ name: '/x', type: 'std_msgs/msg/Float64', level: '' }] }] }), null);
});

test('the time line spans a live run, a run with an end, and a rewound one', () => {
  const s = { begin_s: 0, end_s: null, time_s: 4, history_s: [0, 2], replay: false };
  assert.deepEqual(spanOf(s), [0, 4]);
  assert.deepEqual(spanOf({ ...s, end_s: 60 }), [0, 60]);
  assert.deepEqual(spanOf({ ...s, time_s: 1, history_s: [0, 2, 8] }), [0, 8]);
  assert.deepEqual(spanOf({ ...s, kept_from_s: 2 }), [2, 4]);  // what was before is forgotten: only a reset goes there
  assert.deepEqual(spanOf({ ...s, kept_from_s: 2, time_s: 0, history_s: [0, 2, 8] }), [0, 8]);
});

test('completion takes what is common and replaces the last word only', () => {
  assert.equal(commonStart(['rover/laser', 'rover/drive']), 'rover/');
  assert.equal(commonStart([]), '');
  assert.equal(completeLine('set rov', 'rover/laser.noise'), 'set rover/laser.noise');
  assert.equal(completeLine('set ', 'rover'), 'set rover');
});

test('rates: thirty messages a second are thirty hertz; silence fades', () => {
  const meter = new Meter();
  for (let i = 0; i <= 150; i++) meter.add(100 + i / 30, 1000);
  const { hz, bytes } = meter.rates(105);
  assert.ok(Math.abs(hz - 30) < 1.5 && Math.abs(bytes - 30000) < 1500, `${hz}`);
  assert.equal(meter.rates(120).hz, 0);
});

test('a message shows as rows; long lists are folded and cut', () => {
  const message = { header: { stamp: { sec: 1 } }, ranges: new Float32Array(1000) };
  assert.deepEqual(echoRows(message, new Set()).map((r) => r.name), ['header', 'stamp', 'sec', 'ranges']);
  const opened = echoRows(message, new Set(['ranges']));
  assert.equal(opened.length, 4 + 24 + 1);
  assert.equal(opened.at(-1).text, '976 more');
  const loop = {};
  loop.self = loop;
  assert.ok(echoRows(loop, new Set()).length < 20);
});

test('hands in the scene become console lines', () => {
  const drag = { name: 'rover', link: 'base', mode: 'move', phase: 'move', target: [1.00004, 2, 0] };
  assert.equal(dragLine(drag), 'drag rover 1 2 0');
  assert.equal(dragLine({ ...drag, mode: 'turn', yaw: 0.5 }), 'pose rover 1 2 0 0.5');
  assert.equal(dragLine({ ...drag, mode: 'pull', point: [0.1, 0, 0] }), 'pull rover base 0.1 0 0 1 2 0');
  assert.equal(dragLine({ ...drag, mode: 'pull', phase: 'end' }), 'pull rover off');
  assert.equal(dragLine({ ...drag, target: [NaN, 0, 0] }), null);
});

test('the palette finds by letters in order, beginnings first', () => {
  assert.equal(score('Reset', 'xyz'), 0);
  assert.ok(score('Reset', 're') > score('Fire', 're'));
  assert.ok(score('rover_2/laser', 'r2l') > 0);
});

test('another run of the server is another past, even of the same epoch', () => {
  const store = new Store();
  store.setWorld(structuredClone(world));
  store.select('bob');
  const epochs = [];
  store.onEpoch.on((epoch) => epochs.push(epoch));
  store.forget();
  assert.deepEqual([store.world, store.selection, store.instance('bob')], [null, null, undefined]);
  store.setWorld(structuredClone(world));
  assert.deepEqual(epochs, [-1], 'what was kept by time was dropped once');
});

test('the graph of one robot has its neighbours, and nobody whose name begins alike', () => {
  const graph = {
    publishedTopics: new Map([['/ann/scan', ['ann/laser']], ['/anna/scan', ['anna/laser']], ['/map', ['mapper']]]),
    subscribedTopics: new Map([['/ann/scan', ['mapper']], ['/map', ['ann/driver']]]), advertisedServices: new Map(),
  };
  const of = (robot) => [...graphOf(graph, '', false, robot).nodes.keys()].sort();
  assert.deepEqual(of('ann'), ['n:ann/driver', 'n:ann/laser', 'n:mapper', 't:/ann/scan', 't:/map']);
  assert.deepEqual(of('anna'), ['n:anna/laser', 't:/anna/scan']);
  assert.equal(of('').length, 7);
});

test('the unit of an address that was shown', () => {
  assert.equal(format.unitOf('rover.pose.x = -1.5e-3 m', 'rover.pose.x'), 'm');
  assert.equal(format.unitOf('rover.count = 3', 'rover.count'), '');
  assert.equal(format.unitOf("there is no 'x m'", 'x'), '');
});

const figures = await load('ui/client_figures.ts');
const { filterLog, withSource } = await load('ui/log.ts');
const answered = (more) => ({ path: 'red1/brain', control_period_s: 0.05, deadline_s: 0.1, steps: 200, misses: 0, waiting_s: null, latency_s: { last: 0.01, mean: 0.01, p99: 0.02, max: 0.03 }, step_s: null, latencies: { first_s: 1e-3, per_decade: 20, counts: [] }, ...more });
const client = (more) => ({ id: 1, drives: 'red1', robots: ['red1'], mode: 'lockstep', programs: [answered()], ...more });
const outside = (more) => ({ path: 'red1/brain', kind: 'remote', is_client: true, connected: true, started: false, answers: 0, misses: 0, ...more });

test('times of clients are read at a glance', () => {
  assert.deepEqual([2.5e-5, 9.994e-4, 0.0123, 0.5, 1.5, 61, 600].map(figures.formatDuration), ['25 µs', '999 µs', '12.3 ms', '500 ms', '1.50 s', '1 min', '10 min']);
  assert.deepEqual([3, 240, 7200].map(figures.formatAge), ['3 s', '4 min', '2 h']);
  assert.equal(figures.missedShare(answered()), '0');
  assert.equal(figures.missedShare(answered({ misses: 3 })), '3 (1.5 %)');
  assert.equal(figures.missedShare(answered({ misses: 100 })), '100 (50 %)');
});

test('a client that is silent is bad, one that comes close to its deadline a warning', () => {
  assert.equal(figures.judge(answered()), 'good');
  assert.equal(figures.judge(answered({ waiting_s: 0.05 })), 'good');
  assert.equal(figures.judge(answered({ waiting_s: 0.2 })), 'good', 'late is not silent');
  assert.equal(figures.judge(answered({ waiting_s: 1.2 })), 'bad');
  assert.equal(figures.judge(answered({ latency_s: { last: 0, mean: 0, p99: 0.081, max: 0.09 } })), 'warn');
  assert.equal(figures.judge(answered({ latency_s: null })), 'good');
});

test('latencies lie on a logarithmic axis up to the deadline, late ones in its last column', () => {
  // 0.1 ms to 100 ms are three decades: 1 ms is a third of the way.
  assert.ok(Math.abs(figures.place(1e-3, 0.1) - 1 / 3) < 1e-12);
  assert.equal(figures.place(1e-6, 0.1), 0);
  assert.ok(figures.place(0.2, 0.1) > 1);
  // 100 answers from 1 ms on, and one of 400 ms: 2.6 decades above it, 52 bins.
  const counts = [100, ...new Array(51).fill(0), 1];
  const columns = figures.columnsOf(answered({ latencies: { first_s: 1e-3, per_decade: 20, counts } }), 31);
  assert.equal(columns[10], 1);
  assert.equal(columns[30], 0.16, 'one of a hundred is seen');
  assert.equal(columns.filter((share) => share > 0).length, 2);
});

test('a robot that nobody drives has a row, and so has a process', () => {
  const rows = (programs, clients) => figures.rowsOfPrograms(programs, clients).map((p) => p.path);
  assert.deepEqual(rows([outside(), outside({ path: 'red2/brain' })], [client()]), ['red2/brain']);
  assert.deepEqual(rows([outside({ started: true })], [client()]), ['red1/brain'], 'it can be restarted');
  assert.deepEqual(rows([outside({ is_client: false, kind: 'pipe' })], []), ['red1/brain']);
  assert.deepEqual(figures.stateOf(outside(), []), ['Waits for a client', 'warn']);
  assert.deepEqual(figures.stateOf(outside({ started: true }), []), ['Its process has not connected', 'warn']);
  assert.deepEqual(figures.stateOf(outside({ started: true }), [client()]), ['Runs as client 1', 'good']);
  assert.deepEqual(figures.stateOf(outside(), [client({ mode: 'free', programs: [] })]), ['Driven freely by client 1', 'good']);
  assert.deepEqual(figures.stateOf(outside({ is_client: false, connected: false }), []), ['Has ended', 'bad']);
});

test('what a program writes is in the log under its path', () => {
  const entry = (text, name = 'sandlot') => ({ time_s: 0, level: 30, name, text });
  const known = (path) => path === 'ann/brain';
  assert.deepEqual(withSource(entry('ann/brain: hello: world'), known), entry('hello: world', 'ann/brain'));
  assert.deepEqual(withSource(entry('bob/brain: hello'), known), entry('bob/brain: hello'));
  assert.deepEqual(withSource(entry('no such thing'), known), entry('no such thing'));
  const all = [entry('a', 'ann/brain'), entry('b')];
  assert.deepEqual(filterLog(all, 10, '', 'ann/brain').map((e) => e.text), ['a']);
  assert.equal(filterLog(all, 10, '').length, 2);
});
