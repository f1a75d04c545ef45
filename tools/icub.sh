#!/usr/bin/env bash
# From a fresh checkout to a tested humanoid: examples/04-icub.
#
#   tools/icub.sh             runs it and serves the page
#   tools/icub.sh COMMAND …   runs a command with the environment for YARP, the iCub and its plug-ins

. "$(dirname "$0")/env.sh"
. tools/packages.sh

tools/bootstrap.sh demo
# For MuJoCo's software rendering.
need_packages libegl1 libgl1-mesa-dri
python=$(tools/venv.sh icub)
settings=$(tools/middleware.sh yarp)
eval "$settings"
export PATH=$python:$PATH
[ $# -gt 0 ] || tools/build.sh
quietly tools/plugins.sh examples/04-icub

export RTF_PLUGIN_PATH=$BUILD/examples/04-icub
if [ $# -gt 0 ]; then
  exec "$@"
fi
say
say "\$ rtf run examples/04-icub/icub.xml --web"
status=0
"$TARGET/release/rtf" run examples/04-icub/icub.xml --web || status=$?
say
say "to open the run in a browser: ${TARGET#"$ROOT"/}/release/rtf serve"
exit "$status"
