import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { actsOn } = await load('ui/controllers_section.ts');

test('a controller offers what leads out of its state, and an active one is never unloaded', () => {
  const words = (state) => actsOn(state).map(([act]) => act);
  assert.deepEqual(words('unconfigured'), ['configure', 'unload']);
  assert.deepEqual(words('inactive'), ['start', 'unload']);
  assert.deepEqual(words('active'), ['stop']);
});
