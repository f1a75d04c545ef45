#!/bin/sh
# Node's test runner: nested subtests, durations.
exec node --test-reporter=tap "$(dirname "$0")/arm.test.mjs"
