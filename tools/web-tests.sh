#!/usr/bin/env bash
# Looks at the page in a real Chromium while a real rtf runs.
#
#   tools/web-tests.sh [FILE …]    web/tests/*.test.mjs, or these
#
# RTF names another rtf than the one that `make build` has built.

. "$(dirname "$0")/env.sh"

tools/web.sh modules
simulation=$(tools/venv.sh demo)
# The arm of the examples needs its own Python, before the one that Node may come with.
PATH=$simulation:$(tools/node.sh):$PATH
export PATH RTF=${RTF:-$TARGET/release/rtf}
[ -x "$RTF" ] || die "$RTF is missing" "make build"

[ $# -gt 0 ] || set -- web/tests/*.test.mjs
# One after the other: each measures its patience by a machine of its own.
exec node --test --test-concurrency=1 "$@"
