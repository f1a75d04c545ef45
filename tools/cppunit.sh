#!/usr/bin/env bash
# Builds build/librtf-cppunit.so, which rtf preloads into programs with CppUnit tests. Without
# CppUnit's headers or a C++ compiler, prints a note and builds nothing.

. "$(dirname "$0")/env.sh"

compiler=${CXX:-c++}
source=sdk/cpp/preload/cppunit.cpp
library=$BUILD/librtf-cppunit.so
options=(-std=c++11 -O2 -g0 -fPIC -fvisibility=hidden -pthread -Isdk/cpp/include)

if ! have "$compiler" ||
  ! "$compiler" "${options[@]}" -fsyntax-only -include cppunit/TestResult.h -x c++ /dev/null 2>/dev/null; then
  say "note: librtf-cppunit.so is not built, because $compiler or CppUnit's headers are missing (libcppunit-dev)"
  exit 0
fi

mkdir -p "$BUILD"
if [ -e "$library" ] && [ -z "$(find "$source" sdk/cpp/include/rtf -newer "$library" -name '*pp')" ]; then
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$compiler" "${options[@]}" -Wall -Wextra -Wpedantic -Werror -c "$source" -o "$work/cppunit.o"
# The library is also loaded into programs without CppUnit.
objcopy --wildcard --weaken-symbol='_ZN7CppUnit*' --weaken-symbol='_ZNK7CppUnit*' \
  --weaken-symbol='_ZTIN7CppUnit*' --weaken-symbol='_ZTVN7CppUnit*' "$work/cppunit.o"
"$compiler" -shared -pthread "$work/cppunit.o" -o "$work/library.so" -ldl
mv "$work/library.so" "$library" # a running program keeps the old one
