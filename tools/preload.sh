#!/usr/bin/env bash
# Builds the libraries that rtf preloads into programs of other frameworks:
# librtf-fork-server.so, librtf-report.so, and librtf-cppunit.so. Without CppUnit's headers or a C++ compiler,
# prints a note and does not build the last one.
#
#   tools/preload.sh [DIRECTORY [LIBRARY]]     default: build, all; fork_server, report or cppunit
#
# CC, CXX and OBJCOPY may be those for another processor; CC may have options.

. "$(dirname "$0")/env.sh"

sources=sdk/cpp/preload
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
directory=${1:-$BUILD}
mkdir -p "$directory"
read -r -a cc <<<"${CC:-cc}"

# Whether a library is missing or older than one of its sources: library, sources.
is_outdated() {
  local library=$1
  shift
  [ ! -e "$library" ] || [ -n "$(find "$@" -newer "$library" -name '*.[ch]*')" ]
}

# A library in C: its name, its source.
build_c() {
  local library=$directory/librtf-$1.so
  is_outdated "$library" "$sources/$2" $sources/*.h || return 0
  "${cc[@]}" -std=gnu11 -O2 -g0 -fPIC -fvisibility=hidden -Wall -Wextra -Wpedantic -Werror -shared -s \
    "$sources/$2" -o "$work/$1.so" -pthread -ldl
  mv "$work/$1.so" "$library" # a running program keeps the old one
}

build_fork_server() {
  build_c fork-server fork_server.c
}

build_report() {
  build_c report report.c
}

build_cppunit() {
  local library=$directory/librtf-cppunit.so compiler=${CXX:-c++}
  local options=(-std=c++11 -O2 -g0 -fPIC -fvisibility=hidden -pthread -Isdk/cpp/include)
  if ! have "$compiler" ||
    ! "$compiler" "${options[@]}" -fsyntax-only -include cppunit/TestResult.h -x c++ /dev/null 2>/dev/null; then
    say "note: librtf-cppunit.so is not built, because $compiler or CppUnit's headers are missing (libcppunit-dev)"
    return 0
  fi
  is_outdated "$library" $sources/cppunit.cpp $sources/*.h sdk/cpp/include/rtf || return 0
  "$compiler" "${options[@]}" -Wall -Wextra -Wpedantic -Werror -c $sources/cppunit.cpp -o "$work/cppunit.o"
  # The library is also loaded into programs without CppUnit.
  "${OBJCOPY:-objcopy}" --wildcard --weaken-symbol='_ZN7CppUnit*' --weaken-symbol='_ZNK7CppUnit*' \
    --weaken-symbol='_ZTIN7CppUnit*' --weaken-symbol='_ZTVN7CppUnit*' "$work/cppunit.o"
  "$compiler" -shared -pthread "$work/cppunit.o" -o "$work/cppunit.so" -ldl
  mv "$work/cppunit.so" "$library"
}

for library in ${2:-fork_server report cppunit}; do
  "build_$library"
done
