#!/usr/bin/env bash
# Creates the pictures in docs/images: example 02 while it runs, and a past run. Run
# `make build` first.

. "$(dirname "$0")/env.sh"

tools/bootstrap.sh test
simulation=$(tools/venv.sh demo)
RTF_MCAP_PYTHON=$(tools/venv.sh mcap)/python
tools/web.sh modules
[ -x "$TARGET/release/rtf" ] || die "$TARGET/release/rtf is missing" "make build"
# Called by its name as users do, because the command is in the picture.
PATH=$simulation:$TARGET/release:$(tools/node.sh):$PATH
export PATH RTF=rtf RTF_MCAP_PYTHON

mkdir -p docs/images
exec node web/tests/screenshots.mjs docs/images
