#!/bin/sh
# The cases of tests/frameworks/promises.json.
echo 1..3
echo 'ok 1 - first'
if sh -c "$PROMISE"; then echo 'ok 2 - second'; else echo 'not ok 2 - second'; fi
echo 'ok 3 - third'
test -z "$MEASURES" || printf '  ---\n  duration_ms: 2.5\n  ...\n'
