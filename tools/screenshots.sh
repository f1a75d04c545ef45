#!/usr/bin/env bash
# Makes the pictures in docs/images: example 02 while it runs, and what there is
# to be seen of a run afterwards. Needs what `make build` has built.

. "$(dirname "$0")/env.sh"

tools/bootstrap.sh test
simulation=$(tools/venv.sh demo)
tools/web.sh modules
[ -x "$TARGET/release/rtf" ] || die "$TARGET/release/rtf is missing" "make build"
# By its name, as a user calls it: the command is in the picture.
PATH=$simulation:$TARGET/release:$(tools/node.sh):$PATH
export PATH RTF=rtf

mkdir -p docs/images
exec node web/tests/screenshots.mjs docs/images
