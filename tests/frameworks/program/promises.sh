#!/bin/sh
# The program of tests/frameworks/promises.json.
sh -c "$PROMISE" || exit
if [ -n "$MEASURES" ]; then
  PYTHONPATH=$(dirname "$0")/../../../sdk/python exec python3 -c "
import rtf.session
rtf.session.current().measure('force', 2.5, 'N', high=$MEASURES)"
fi
