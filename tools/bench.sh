#!/usr/bin/env bash
# Measures speed and memory, side by side with the peers. Options: benches/run.sh --help.

. "$(dirname "$0")/env.sh"

tools/build.sh
exec benches/run.sh "$@"
