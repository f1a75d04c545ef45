import assert from 'node:assert';
import { test } from 'node:test';

test('arm', async (t) => {
  await t.test('moves', () => {});
  await t.test('reaches', () => assert.strictEqual(1, 2)); // line: reaches
});
test('skips', { skip: 'no gripper' }, () => {});
test('later', { todo: 'not calibrated' }, () => {
  throw new Error('not calibrated');
});
