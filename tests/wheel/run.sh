#!/usr/bin/env bash
# Installs a wheel with pip into an empty virtual environment and uses it as a new user does:
# tests in Python and Lua with nothing but the environment in PATH, then a C++ plug-in.
#
#   tests/wheel/run.sh           builds the wheel of target/release, twice: both are the same
#   tests/wheel/run.sh WHEEL     that wheel

. "$(dirname "$0")/../../tools/env.sh"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=$(tools/venv.sh wheel)

if [ $# -gt 0 ]; then
  wheel=$(realpath "$1")
else
  wheel=$(tools/wheel.sh)
  cp "$wheel" "$work/first.whl"
  wheel=$(tools/wheel.sh)
  cmp "$work/first.whl" "$wheel" || die "the wheel differs when it is built twice"
fi

venv=$work/venv
python3 -m venv "$venv"
files_of() { find "$venv" ! -type d ! -path '*/__pycache__/*' | sort; }
files_of >"$work/before.txt"
cp -R tests/install/downstream "$work/project"
cp tests/wheel/* "$work/project"
cd "$work/project"

alone=(env -i "PATH=$venv/bin" "HOME=$work" LC_ALL=C.UTF-8)
started=$EPOCHREALTIME
"${alone[@]}" "$venv/bin/pip" install --quiet --disable-pip-version-check --no-index "$wheel"
for program in "$venv"/bin/rtf "$venv"/libexec/rtf/rtf-host-*; do
  ! grep -q -a -F -e "$ROOT/sdk" -e "$ROOT/target" "$program" || die "$program knows where the checkout is"
done
say "pip install: $(((${EPOCHREALTIME/./} - ${started/./}) / 1000)) ms"

# Runs a command of the environment; it must exit with this status.
expect() {
  local wanted=$1 status=0
  shift
  "${alone[@]}" "$@" >"$work/output.txt" 2>&1 || status=$?
  cat "$work/output.txt"
  [ "$status" -eq "$wanted" ] || die "\`$*\` exited with $status, expected $wanted"
}

expect_in_output() {
  grep -q -F -e "$1" "$work/output.txt" || die "missing in the output: $1"
}

expect 0 rtf --version
expect 0 python -m rtf --version
expect 0 robottestingframework-testrunner --version
expect 0 rtf doctor dll lua python ros2shm # ros2shm is a fixture
expect 1 rtf run scripts.xml
expect_in_output '3 passed, 1 failed'
# Without python3 in PATH, the interpreter that runs the module runs the plug-ins.
alone[2]=PATH=$work/no-such-directory
expect 2 "$venv/bin/rtf" run scripts.xml
# shellcheck disable=SC2016 # no expansion
expect_in_output 'plug-ins of type `python` need'
expect 1 "$venv/bin/python" -m rtf run scripts.xml
expect_in_output '3 passed, 1 failed'
alone[2]=PATH=$venv/bin:/usr/bin:/bin
expect 1 robottestingframework-testrunner --suite scripts.xml
expect_in_output 'Number of failed test cases  : 1'

expect 0 python -c 'from importlib.metadata import entry_points as find; find(group="pytest11")["rtf"]'
"$tools/mypy" --strict --python-executable "$venv/bin/python" --cache-dir "$work/mypy" PythonTest.py FailingTest.py

# CMake searches the prefixes of PATH.
expect 0 cmake -S . -B build
expect_in_output 'Build files have been written'
grep -q -F "rtf_DIR:PATH=$venv/lib/cmake/rtf" build/CMakeCache.txt || die "CMake found another rtf"
expect 0 cmake --build build
expect 1 env RTF_PLUGIN_PATH=build rtf run suite.xml
expect_in_output '3 passed, 1 failed'

"${alone[@]}" pip uninstall --quiet --yes robot-testing-framework
files_of | diff "$work/before.txt" - || die "pip uninstall left files"
