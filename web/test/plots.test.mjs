import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { PlotData, Series } = await load('plots/series.ts');
const { toCsv, fileName } = await load('plots/csv.ts');
const { colorTable, paint } = await load('plots/colormaps.ts');
const { gridsOf, Waterfall } = await load('plots/grids.ts');

test('a full series forgets its oldest and keeps its order', () => {
  const s = new Series(2000);
  for (let i = 0; i < 5000; i++) s.push(i, -i);
  assert.equal(s.length, 2000);
  assert.equal(s.time(0), 3000);
  assert.equal(s.value(1999), -4999);
  assert.equal(s.lowerBound(3500), 500);
  assert.equal(s.lowerBound(3500.5), 501);
  assert.equal(s.lowerBound(1e9), 2000);
  for (let i = 1; i < s.length; i++) assert.ok(s.time(i) > s.time(i - 1));
});

test('a value that joins later has gaps before', () => {
  const d = new PlotData();
  d.addSeries();
  d.push(1, [10]);
  d.push(2, [20]);
  d.addSeries();
  d.push(3, [30, 300]);
  assert.deepEqual(d.columns(0, 10, 100), [[1, 2, 3], [10, 20, 30], [null, null, 300]]);
  d.removeSeries(0);
  assert.deepEqual(d.columns(0, 10, 100), [[1, 2, 3], [null, null, 300]]);
});

test('time that runs back begins anew; the same time again changes nothing', () => {
  const d = new PlotData();
  d.addSeries();
  d.push(5, [1]);
  d.push(5, [2]);
  assert.equal(d.times.length, 1);
  d.push(1, [3]);
  assert.deepEqual(d.columns(0, 10, 10), [[1], [3]]);
});

test('thinning keeps the peak, the gaps and rising times', () => {
  const d = new PlotData();
  d.addSeries();
  for (let i = 0; i < 20_000; i++) d.push(i * 0.01, [i === 12_345 ? 99 : i >= 5000 && i < 9000 ? NaN : Math.sin(i)]);
  const [times, values] = d.columns(0, 200, 300);
  assert.ok(times.length <= 600);
  assert.equal(Math.max(...values.filter((v) => v !== null)), 99);
  assert.ok(values.includes(null));
  for (let i = 1; i < times.length; i++) assert.ok(times[i] > times[i - 1], `${i}`);
});

test('CSV holds the exact numbers and quotes what needs it', () => {
  const d = new PlotData();
  d.addSeries();
  d.addSeries();
  d.push(0.1 + 0.2, [1 / 3, NaN]);
  d.push(1, [Infinity, -0.5]);
  const text = toCsv(d, ['hypot(a.x, b.x)', 'a "b"']);
  const lines = text.split('\n');
  assert.equal(lines[0], 'time,"hypot(a.x, b.x)","a ""b"""');
  assert.equal(Number(lines[1].split(',')[0]), 0.1 + 0.2);
  assert.equal(Number(lines[1].split(',')[1]), 1 / 3);
  assert.equal(lines[1].split(',')[2], '');
  assert.equal(lines[2], '1,inf,-0.5');
  assert.equal(fileName('hypot(a/b, c)', 'csv'), 'hypot-a-b-c.csv');
});

test('colours: ends of the tables, limits, and nothing for no number', () => {
  assert.deepEqual([...colorTable('viridis').slice(0, 3)], [0x44, 0x01, 0x54]);
  assert.deepEqual([...colorTable('viridis').slice(-3)], [0xfd, 0xe7, 0x25]);
  const grey = colorTable('grey');
  const pixels = new Uint8ClampedArray(16);
  paint([-5, 0.5, 7, NaN], 0, 1, grey, pixels);
  assert.deepEqual([...pixels], [0, 0, 0, 255, 128, 128, 128, 255, 255, 255, 255, 255, 0, 0, 0, 0]);
  paint([3, 3, 3, 3], 3, 3, grey, pixels);  // a constant has no range
  assert.equal(pixels[3], 255);
});

test('grids of messages: maps, arrays with dimensions, scans, images that lie', () => {
  const map = gridsOf({ info: { width: 3, height: 2 }, data: new Int8Array(6) }, 'nav_msgs/msg/OccupancyGrid')[0];
  assert.deepEqual([map.columns, map.rows, map.flip], [3, 2, true]);
  const multi = gridsOf({ layout: { dim: [{ size: 2 }, { size: 4 }] }, data: new Float32Array(8) }, 'std_msgs/msg/Float32MultiArray')[0];
  assert.deepEqual([multi.columns, multi.rows], [4, 2]);
  const scan = gridsOf({ header: {}, ranges: new Float32Array(5), intensities: [] }, 'sensor_msgs/msg/LaserScan');
  assert.deepEqual(scan.map((g) => [g.path, g.columns, g.rows]), [['ranges', 5, 1]]);
  assert.deepEqual(gridsOf({ width: 100, height: 100, step: 100, encoding: 'mono8', data: new Uint8Array(99) }, 'sensor_msgs/msg/Image'), []);
  const image = gridsOf({ width: 2, height: 1, step: 8, encoding: 'rgb8', data: new Uint8Array([255, 255, 255, 0, 0, 0, 9, 9]) }, 'sensor_msgs/msg/Image')[0];
  assert.ok(Math.abs(image.values[0] - 255) < 1e-3 && image.values[1] === 0);
  const fall = new Waterfall(2, 3);
  for (const t of [1, 2, 3, 4]) fall.push(t, [t, -t]);
  assert.deepEqual([...fall.values], [4, -4, 3, -3, 2, -2]);
  assert.deepEqual([...fall.times], [4, 3, 2]);
});
