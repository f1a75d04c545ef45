#!/usr/bin/env node
// tape: YAML diagnostics, the same description twice.
const test = require('tape');

test('arm moves', (t) => {
  t.equal(1.5, 2, 'speed'); // line: speed
  t.ok(true, 'fine');
  t.ok(true, 'fine');
  t.deepEqual({ a: 1 }, { a: 2 });
  t.end();
});
test('later', { todo: true }, (t) => {
  t.ok(false, 'not ready');
  t.end();
});
