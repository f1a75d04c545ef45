#!/usr/bin/env bash
# Gives arbitrary inputs to everything that reads bytes of others. Options: tools/fuzz.py --help.

. "$(dirname "$0")/env.sh"

# As tools/build.sh, whose libraries are used.
unset SOURCE_DATE_EPOCH

exec python3 tools/fuzz.py "$@"
