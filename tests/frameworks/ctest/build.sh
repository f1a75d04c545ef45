# shellcheck shell=bash
# shellcheck disable=SC2154 # source, out: set by tests/frameworks/build.sh
# CTest comes with CMake.
need_packages cmake gcc g++ ninja-build
program_with_descendants
quietly cmake -S "$source" -B "$out/arm"
# Its programs stay unbuilt.
quietly cmake -S "$source/unbuilt" -B "$out/unbuilt-build" -G 'Ninja Multi-Config'
quietly cmake -S "$source/circular" -B "$out/circular-build"
quietly cmake -S "$source/repeat" -B "$out/repeat-build"
quietly cmake --build "$out/arm"
quietly cmake -S "$source/promises" -B "$out/promises"
quietly cmake -S "$source/descendants" -B "$out/descendants" "-DPROGRAM=$out/descendants_test"
# No build directory.
mkdir -p "$out/empty"
