#!/usr/bin/env bash
# Installs a test framework that is missing, and builds its corpus into build/frameworks/TYPE.
#
#   tests/frameworks/build.sh TYPE     one of the directories in tests/frameworks
#
# Prints the exports that the corpus needs, often none:
#
#   eval "$(tests/frameworks/build.sh gtest)"
#
# tests/frameworks/TYPE/build.sh does the work: it is sourced with `source` and `out`, the
# directories of the corpus and of its build. Messages go to stderr.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh

known=$(dirname tests/frameworks/*/build.sh | xargs -n 1 basename | paste --serial --delimiters=' ')
type=${1:?type: one of $known}
[ -e "tests/frameworks/$type/build.sh" ] || die "no corpus \`$type\`" "known are: $known"
source=$ROOT/tests/frameworks/$type
out=$BUILD/frameworks/$type
mkdir -p "$out" "$CACHE"

# Prints an export, quoted for a shell.
setting() {
  printf 'export %s=%q\n' "$1" "$2"
}

# Compiles each C++ program of the corpus that is older than its sources or the SDK's headers:
# NAME.cpp to NAME, and the libraries that rtf loads into them. Arguments are for the compiler and the linker.
cpp_programs() {
  local file program headers=sdk/cpp/include
  quietly tools/preload.sh
  install -m 755 tests/frameworks/descendants/twice_test.sh "$out/twice_test"
  for file in "$source"/*.cpp; do
    program=$out/$(basename "$file" .cpp)
    if [ "$file" -nt "$program" ] || [ "$source/build.sh" -nt "$program" ] ||
      [ tests/frameworks/descendants/descendants.hpp -nt "$program" ] ||
      [ -n "$(find $headers/rtf -newer "$program")" ]; then
      quietly "${CMAKE_CXX_COMPILER_LAUNCHER:-env}" c++ -std=c++17 -g -O0 -Wall -I$headers -c -o "$program.o" "$file" "$@"
      quietly c++ -g -o "$program" "$program.o" "$@"
    fi
  done
}

# Compiles the program of tests/frameworks/descendants that needs no framework.
program_with_descendants() {
  local program=$out/descendants_test sources=tests/frameworks/descendants
  if [ ! -e "$program" ] || [ -n "$(find $sources -name '*.?pp' -newer "$program")" ]; then
    quietly c++ -std=c++17 -g -O0 -Wall -o "$program" $sources/descendants_test.cpp
  fi
}

# Only one process at a time may install or build it.
exec 8>"$CACHE/framework-$type.lock"
flock 8

# shellcheck source=/dev/null
. "$source/build.sh"
setting RTF_PLUGIN_PATH "$out"
