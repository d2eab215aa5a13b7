import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { errorViews, joined, representatives, sliderMost } = await load('ui/error_models.ts');

const listed = (address, value, unit = '') => ({ address, unit, help: '', value, count: 0 });
const device = (path, kind) => ({ name: path.split('/')[1], path, kind, active: [], topics: [], commands: [] });

test('stages of noise become sliders, other values do not', () => {
  const views = errorViews('ann/front', [
    listed('ann/front.range', 1.2, 'm'),
    listed('ann/front.noise.white', 0, 'm'),
    listed('ann/front.noise.stages[0].gaussian.std', 0.02, 'm'),
    listed('ann/front.noise.stages[0].gaussian.mean', 0, 'm'),
    listed('ann/front.noise.stages[1].salt_and_pepper.salt', 0, '1'),
    listed('ann/front.noise.stages[1].salt_and_pepper.pepper', null, '1'),
  ]);
  assert.deepEqual(views.map((v) => [v.address, v.label, v.group, v.unit]), [
    ['ann/front.noise.stages[0].gaussian.std', 'std', 'noise › gaussian', 'm'],
    ['ann/front.noise.stages[1].salt_and_pepper.salt', 'salt', 'noise › salt and pepper', ''],
  ]);
  assert.deepEqual([views[0].slider.max, views[0].max, views[1].max], [0.2, null, 1]);
  const [drive] = errorViews('ann/drive', [listed('ann/drive.command_errors.linear.stages[0].gaussian.std', 0, 'm/s')]);
  assert.equal(drive.group, 'command errors › linear › gaussian');
});

test('a slider reaches what holds already', () => {
  assert.equal(sliderMost('std', 'm', 0), 0.2);
  assert.equal(sliderMost('std', 'm', 3), 10);
  assert.equal(sliderMost('std', 'rad/s', 0.4), 0.5);
  assert.equal(sliderMost('rate', '1', 0.5), 1);
  assert.equal(sliderMost('delay', 's', 0), 1);
});

test('one device of each kind stands for all that are like it', () => {
  const world = { kinds: { psd: { fields: [{ path: 'errors' }] }, screen: { fields: [{ path: 'width' }] } } };
  const robot = (name, model) => ({ name, model, devices: [device(`${name}/front`, 'psd'), device(`${name}/left`, 'psd'), device(`${name}/lcd`, 'screen'), device(`${name}/drive`, 'diff_drive')] });
  const found = representatives(world, [robot('ann', 'm1'), robot('bob', 'm1'), robot('cat', 'm2')]);
  assert.deepEqual(found.map(({ device: d, same }) => [d.path, same.map((s) => s.path)]), [
    ['ann/front', ['ann/front', 'ann/left', 'bob/front', 'bob/left']],
    ['ann/drive', ['ann/drive', 'bob/drive']],
    ['cat/front', ['cat/front', 'cat/left']],
    ['cat/drive', ['cat/drive']],
  ]);
  const view = (of) => errorViews(of, [listed(`${of}.noise.stages[0].gaussian.std`, 0, 'm')]);
  const sliders = joined([found[0], found[2]].map((each) => ({ ...each, views: view(each.device.path) })));
  assert.equal(sliders.length, 1);
  assert.equal(sliders[0].view.group, 'psd › noise › gaussian');
  assert.deepEqual(sliders[0].addresses, ['ann/front', 'ann/left', 'bob/front', 'bob/left', 'cat/front', 'cat/left'].map((p) => `${p}.noise.stages[0].gaussian.std`));
});
