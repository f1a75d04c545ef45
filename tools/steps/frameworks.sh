# shellcheck shell=bash
# shellcheck disable=SC2154 # tools/test.sh sets `checkers` and `simulation`
# Tests of other frameworks, and the builds of their users. tools/test.sh sources this file.

# The tests of a package on PyPI, compared with pytest's own report.
public_pytest() {
  local interpreter
  interpreter=$(tools/venv.sh pytest)/python
  python3 tests/frameworks/public/pytest_boltons.py "$TARGET/release/rtf" "$interpreter"
}

# Projects with many plug-ins, options and layouts, compared with pytest's own JUnit file.
pytest_projects() {
  local interpreter
  interpreter=$(tools/venv.sh pytest-projects)/python
  python3 tests/frameworks/pytest_projects/check.py "$TARGET/release/rtf" "$interpreter"
}

example_09() {
  local type settings plugins=$BUILD/examples/09-other-frameworks
  for type in gtest catch2 cppunit aunit junit; do
    settings=$(tests/frameworks/build.sh "$type")
    eval "$settings"
  done
  rtf_DIR=$ROOT/sdk/cpp/cmake/rtf \
    GPR_PROJECT_PATH=$ROOT/sdk/ada examples/09-other-frameworks/build.sh "$plugins"
  PATH="$simulation:$PATH" RTF_PYTHON=$checkers/python RTF_PLUGIN_PATH=$plugins \
    python3 tools/check_example_09.py "$TARGET/release/rtf" examples/09-other-frameworks
}

# GoogleTest's own tests, compared with its own report.
public_gtest() {
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages googletest cmake g++
  python3 tests/frameworks/public/gtest_googletest.py "$TARGET/release/rtf"
}

# `rtf import` of a colcon workspace with packages of ament and plain CMake.
import_colcon() {
  local colcon
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake ament-cmake-googletest ament-cmake-pytest libgtest-dev cmake g++
  colcon=$(tools/venv.sh colcon)
  PATH="$colcon:$PATH" RTF_PYTHON=$colcon/python \
    python3 tests/import/check.py "$TARGET/release/rtf" "$BUILD/import"
}

# `rtf_add_suite`: one run of a suite has the results of its CTest tests.
suites_in_ctest() {
  python3 tests/ctest/check.py "$TARGET/release/rtf" sdk/cpp/cmake/rtf "$BUILD/ctest"
}

# `ament_add_rtf_suite` in a colcon workspace with packages of ament and Python.
suites_in_colcon() {
  local colcon
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake cmake g++
  colcon=$(tools/venv.sh colcon)
  PATH="$colcon:$PATH" RTF_PYTHON=$colcon/python \
    python3 tests/colcon/check.py "$TARGET/release/rtf" sdk/cpp/cmake/rtf "$BUILD/colcon"
}

# The tutorial, with the installed rtf and real nodes.
tutorial_ros2_workspace() {
  local colcon prefix=$BUILD/tutorial/prefix
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake cmake g++
  colcon=$(tools/venv.sh colcon)
  PREFIX=$prefix DESTDIR='' tools/install.sh
  # Python is that of rclpy; colcon has its own.
  mkdir -p "$BUILD/tutorial/bin"
  ln -sf "$colcon/colcon" "$BUILD/tutorial/bin/colcon"
  PATH="$BUILD/tutorial/bin:$PATH" \
    python3 tests/colcon/tutorial.py "$prefix" "$BUILD/tutorial/workspace"
}

# The corpus of a test framework, the promises to it, and programs of it whose cases start processes, see
# tests/frameworks/check.py, promises.py and descendants/check.py.
framework() {
  local settings
  settings=$(tests/frameworks/build.sh "$1")
  eval "$settings"
  python3 tests/frameworks/check.py "$TARGET/release/rtf" "$1"
  python3 tests/frameworks/promises.py "$TARGET/release/rtf" "$1"
  python3 tests/frameworks/descendants/check.py "$TARGET/release/rtf" "$1"
}
