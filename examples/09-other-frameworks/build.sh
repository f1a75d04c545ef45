#!/usr/bin/env bash
# Builds all programs of this lesson into a directory: build.sh [DIRECTORY]
#
# Requires CMake, the C++ SDK of rtf, GoogleTest, Catch2 3, CppUnit, AUnit with gprbuild, a
# JDK, and JUnit's console launcher, whose path is in RTF_JUNIT.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${1:-$here/build}
mkdir -p "$build/repeatability"

cmake -S "$here" -B "$build"
cmake --build "$build"
gprbuild -p -q -P "$here/ada/rest_test.gpr" "-XBUILD=$build"
javac -d "$build/repeatability" -cp "${RTF_JUNIT:?the JAR of the console launcher}" \
  "$here/java/RepeatabilityTest.java"
