#!/usr/bin/env bash
# From a fresh checkout to a tested robot arm: examples/01-simulated-arm.

. "$(dirname "$0")/env.sh"

tools/bootstrap.sh demo
python=$(tools/venv.sh demo)
tools/build.sh
quietly tools/plugins.sh examples/01-simulated-arm

export PATH="$python:$PATH"
export RTF_PLUGIN_PATH=$BUILD/examples/01-simulated-arm
say
say "\$ rtf run examples/01-simulated-arm/arm.xml --web"
status=0
"$TARGET/release/rtf" run examples/01-simulated-arm/arm.xml --web || status=$?
say
say "to open the run in a browser: ${TARGET#"$ROOT"/}/release/rtf serve"
exit "$status"
