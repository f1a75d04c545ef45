#!/usr/bin/env bash
# Changes the code that judges, one small change at a time, and runs the tests of its crate. A change that no test
# notices is printed; the exit code is 1 if more than a tenth of a part is not noticed.
#
#   tools/mutants.sh [PART …] [-- OPTION …]     parts of tools/mutants.py; options of cargo-mutants, `--jobs 2`. Not
#     `--shard`: the second crate would get other changes than the first.

. "$(dirname "$0")/env.sh"

tool=$(tools/cargo_tool.sh cargo-mutants 27.1.0)
export PATH=$tool:$PATH
# Without backtraces, linking takes less time.
export CARGO_PROFILE_DEV_DEBUG=0 CARGO_PROFILE_TEST_DEBUG=0

exec python3 tools/mutants.py "$@"
