#!/bin/sh
# The program of tests/frameworks/promises.json.
sh -c "$PROMISE"
