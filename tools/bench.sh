#!/usr/bin/env bash
# Measures speed and memory, side by side with the peers.

. "$(dirname "$0")/env.sh"

[ -x benches/run.sh ] || die "benches/run.sh is missing: there is nothing to measure yet"
tools/build.sh
exec benches/run.sh
