import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { rgbaOf, pixelAt, soundText, hasPanel } = await load('ui/robot_panel.ts');
const { distanceText } = await load('scene/overlays/beams.ts');

const image = (more) => ({ width: 2, height: 2, step: 7, encoding: 'rgb8', data: Uint8Array.from({ length: 14 }, (_, i) => i + 1), ...more });

test('an image becomes pixels, row by row at its step', () => {
  assert.deepEqual([...rgbaOf(image())], [1, 2, 3, 255, 4, 5, 6, 255, 8, 9, 10, 255, 11, 12, 13, 255]);
});

test('what is no image of a screen is not drawn', () => {
  for (const bad of [{ encoding: 'bgr8' }, { width: 3 }, { height: 3 }, { width: 0 }, { step: 5 }, { width: 5000, step: 15000 }, { data: new Uint8Array(13) }]) {
    assert.equal(rgbaOf(image(bad)), null, JSON.stringify(bad));
  }
});

test('a place on the screen is a pixel, also at its edges', () => {
  const box = { left: 100, top: 50, width: 200, height: 100 };
  assert.deepEqual(pixelAt(100, 50, box, 20, 10), [0, 0]);
  assert.deepEqual(pixelAt(109.9, 69.9, box, 20, 10), [0, 1]);
  assert.deepEqual(pixelAt(300, 150, box, 20, 10), [19, 9]);
  assert.deepEqual(pixelAt(90, 400, box, 20, 10), [0, 9]);
});

test('sounds and distances as people read them', () => {
  assert.equal(soundText({ frequency: 440, name: '' }), '440 Hz');
  assert.equal(soundText({ frequency: 0, name: 'hello.wav' }), 'hello.wav');
  assert.equal(distanceText(0.4249), '0.42 m');
  assert.equal(distanceText(12.34), '12.3 m');
  assert.equal(distanceText(Infinity), '–');
});

test('a robot with any of the three devices has a panel', () => {
  assert.equal(hasPanel({ devices: [{ kind: 'lamp' }] }), false);
  assert.equal(hasPanel({ devices: [{ kind: 'lamp' }, { kind: 'speaker' }] }), true);
  assert.equal(hasPanel({}), false);
});
