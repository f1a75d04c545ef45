#!/usr/bin/env bash
# Builds a directory of C++ plug-ins against the C++ SDK in this checkout.
#
#   tools/plugins.sh examples/01-simulated-arm     into build/examples/01-simulated-arm

. "$(dirname "$0")/env.sh"

dir=${1:?a directory with a CMakeLists.txt}

cmake -S "$dir" -B "$BUILD/$dir" \
  -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -Drtf_DIR="$ROOT/sdk/cpp/cmake/rtf"
cmake --build "$BUILD/$dir" --parallel "$JOBS"
