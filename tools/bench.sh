#!/usr/bin/env bash
# Compares speed and memory with the peers. Options: benches/run.sh --help.

. "$(dirname "$0")/env.sh"

tools/build.sh
exec benches/run.sh "$@"
