#!/usr/bin/env bash
# Tests the page in Chromium with a running rtf.
#
#   tools/web-tests.sh [FILE …]    web/tests/*.test.mjs, or these
#
# RTF overrides the path of rtf, by default the result of `make build`.

. "$(dirname "$0")/env.sh"

tools/web.sh modules
simulation=$(tools/venv.sh demo)
# The arm of the examples needs its own Python, before one that comes with Node.
PATH=$simulation:$(tools/node.sh):$PATH
export PATH RTF=${RTF:-$TARGET/release/rtf}
[ -x "$RTF" ] || die "$RTF is missing" "make build"

[ $# -gt 0 ] || set -- web/tests/*.test.mjs
# Sequentially, because time limits assume an otherwise idle machine.
exec node --test --test-concurrency=1 "$@"
