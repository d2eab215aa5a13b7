import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { cellSize, cellText, edgesOf, elementName, nextScale, orderOf, signedColor, signedMaps, textOn, weightsOf } = await load('plots/weights.ts');
const { phaseScales, fading } = await load('plots/phase.ts');

const message = (rows, columns, data) => ({ layout: { dim: [{ label: 'rows', size: rows, stride: rows * columns }, { label: 'columns', size: columns, stride: columns }], data_offset: 0 }, data: Float64Array.from(data) });

test('a matrix is read row after row, and something else is none', () => {
  const C = weightsOf('C', message(2, 3, [1, 2, 3, 4, 5, 6]));
  assert.equal(C.rows, 2);
  assert.equal(C.columns, 3);
  assert.equal(elementName(C, 5), 'C[1,2]');
  assert.equal(elementName(weightsOf('h', message(3, 1, [1, 2, 3])), 2), 'h[2]');
  assert.equal(weightsOf('C', message(2, 2, [1, 2, 3])), null);
  assert.equal(weightsOf('C', message(0, 3, [])), null);
  assert.equal(weightsOf('C', {}), null);
  assert.equal(weightsOf('C', undefined), null);
});

test('columns lead to rows, and weak connections are left out', () => {
  const edges = edgesOf(weightsOf('C', message(2, 2, [0.5, -1, 0.001, 0])));
  assert.deepEqual(edges, [{ from: 0, to: 0, weight: 0.5 }, { from: 1, to: 0, weight: -1 }]);
  assert.deepEqual(edgesOf(weightsOf('C', message(1, 2, [0, 0]))), []);
});

test('colours go from the ground to the end of the sign and stop there', () => {
  for (const map of Object.values(signedMaps)) {
    assert.deepEqual(signedColor(0, 1, map), map.zero);
    assert.deepEqual(signedColor(1, 1, map), map.positive);
    assert.deepEqual(signedColor(-9, 1, map), map.negative);
    assert.deepEqual(signedColor(5, 0, map), map.zero);
    assert.deepEqual(signedColor(NaN, 1, map), [128, 128, 128]);
  }
  assert.equal(textOn([255, 255, 255]), '#000000');
  assert.equal(textOn([28, 32, 39]), '#ffffff');
});

test('the scale grows at once and shrinks slowly', () => {
  assert.equal(nextScale(0, [1, -3, NaN]), 3);
  assert.equal(nextScale(10, [1]), 9.8);
  assert.equal(nextScale(0, []), 1e-6);
});

test('cells have numbers where they fit', () => {
  assert.deepEqual(cellSize(2, 2, 300, 180), { width: 44, height: 24, numbers: true });
  assert.deepEqual(cellSize(18, 18, 300, 180), { width: 10, height: 10, numbers: false });
  assert.equal(cellSize(200, 200, 300, 180).height, 3);
  assert.deepEqual([0.123, -0.001, 12.34, 250.4, 12345, Infinity].map(cellText), ['0.12', '0.00', '12.3', '250', '1e4', '–']);
});

test('matrices come before vectors, in the order of the equations', () => {
  const all = [['h', 2, 1], ['S', 2, 2], ['C', 2, 2], ['A', 2, 2], ['W', 2, 2], ['x', 2, 1]].map(([n, r, c]) => weightsOf(n, message(r, c, new Array(r * c).fill(0))));
  assert.deepEqual(all.sort(orderOf).map((w) => w.name), ['C', 'A', 'S', 'W', 'h', 'x']);
});

test('a phase plot shows all points with room around them', () => {
  const s = phaseScales([[-1, 1], [0, 2, NaN]]);
  assert.ok(s.x[0] < -1 && s.x[1] > 1 && s.x[0] > -1.3);
  assert.ok(s.y[0] < 0 && s.y[1] > 2);
  assert.deepEqual(phaseScales([[], []]), { x: [-1, 1], y: [-1, 1] });
  assert.equal(fading(0, 100), 0.12);
  assert.equal(fading(99, 100), 1);
});

const { bindingsOf } = await load('app/bindings.ts');
const { Actions } = await load('app/actions.ts');

test('keys of a run are read, and nothing else is taken for one', () => {
  assert.deepEqual(bindingsOf('{"commands":[],"keys":[{"key":"K","line":"kick hard","help":"Kicks"},{"key":"","line":"x","help":""},{"key":"j","line":"jump"},{"line":"y"},null]}'),
    [{ key: 'k', line: 'kick hard', help: 'Kicks' }, { key: 'j', line: 'jump', help: 'jump' }]);
  assert.deepEqual(bindingsOf('all commands'), []);
  assert.deepEqual(bindingsOf('{"keys":7}'), []);
});

test('keys of a run come and go without those of the page', () => {
  const actions = new Actions(() => null, () => undefined);
  let pressed = '';
  actions.add({ id: 'page.a', group: 'Page', title: 'A', keys: ['a'], run: () => (pressed += 'a') });
  actions.add({ id: 'run.k', group: 'Run', title: 'Kick', keys: ['k'], run: () => (pressed += 'k') });
  assert.ok(actions.press('k') && actions.press('a'));
  assert.equal(actions.boundTo('k').title, 'Kick');
  actions.removeGroup('Run');
  assert.equal(actions.press('k'), false);
  assert.ok(actions.press('a'));
  assert.equal(pressed, 'kaa');
});
