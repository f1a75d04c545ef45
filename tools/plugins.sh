#!/usr/bin/env bash
# Builds a folder of C++ plug-ins against the C++ SDK in this checkout.
#
#   tools/plugins.sh examples/01-simulated-arm     into build/examples/01-simulated-arm

. "$(dirname "$0")/env.sh"

folder=${1:?a folder with a CMakeLists.txt}

cmake -S "$folder" -B "$BUILD/$folder" \
  -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DRobotTestingFramework_DIR="$ROOT/sdk/cpp/cmake/RobotTestingFramework"
cmake --build "$BUILD/$folder" --parallel "$JOBS"
