#!/usr/bin/env bash
# Installs the wheel for aarch64 with pip in a root directory of Debian for arm64, under qemu,
# and runs suites, example 07 on its simulator, and the conformance corpus.
#
#   tests/wheel/aarch64.sh WHEEL

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh

wheel=$(realpath "${1:?a wheel}")
need_packages g++-aarch64-linux-gnu cmake
guest=$(tools/arm64_root.sh)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Runs a program of the environment.
cat >"$work/emulated" <<EOF
#!/bin/sh
exec env -i PATH=$work/venv/bin:/usr/bin:/bin HOME=$work LC_ALL=C.UTF-8 RTF_PLUGIN_PATH=$work/project/build \
  "$ROOT/tools/emulate.sh" "$guest" aarch64 "\${PROGRAM:-rtf}" "\$@"
EOF
cat >"$work/native" <<EOF
#!/bin/sh
exec "$TARGET/release/rtf" "\$@"
EOF
chmod +x "$work/emulated" "$work/native"

PROGRAM=/usr/bin/python3 "$work/emulated" -m venv "$work/venv"
started=$EPOCHREALTIME
PROGRAM=pip "$work/emulated" install --quiet --disable-pip-version-check --no-index "$wheel"
say "pip install under qemu: $(((${EPOCHREALTIME/./} - ${started/./}) / 1000)) ms"

cp -R tests/install/downstream "$work/project"
cp tests/wheel/* "$work/project"
cross=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++
  "-DCMAKE_PREFIX_PATH=$work/venv")
cmake -S "$work/project" -B "$work/project/build" "${cross[@]}"
cmake --build "$work/project/build"

cd "$work/project"
"$work/emulated" --version
"$work/emulated" doctor dll lua python ros2shm
for suite in scripts suite; do
  status=0
  "$work/emulated" run "$suite.xml" >output.txt 2>&1 || status=$?
  cat output.txt
  [ "$status" -eq 1 ] || die "rtf exited with $status, expected 1"
  grep -q '3 passed, 1 failed' output.txt || die "not all of $suite.xml passed"
done

# The packages of the simulator for this processor are downloaded without the emulator.
version=$(PROGRAM=/usr/bin/python3 "$work/emulated" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
demo=$ROOT/tools/requirements-demo.txt
platforms=(--platform manylinux_2_28_aarch64 --platform manylinux2014_aarch64)
"$("$ROOT/tools/venv.sh" wheel)/python" -m pip download --quiet --disable-pip-version-check --only-binary=:all: \
  --python-version "$version" "${platforms[@]}" --requirement "$demo" --dest "$work/wheels"
PROGRAM=pip "$work/emulated" install --quiet --disable-pip-version-check --no-index \
  --find-links "$work/wheels" --requirement "$demo"
cp -R "$ROOT/examples" "$work/examples"
"$work/emulated" run "$work/examples/07-levels" --profile ci

for processor in native emulated; do
  options=("-DRobotTestingFramework_DIR=$ROOT/sdk/cpp/cmake/RobotTestingFramework")
  [ $processor = native ] || options=("${cross[@]}")
  cmake -S "$ROOT/conformance" -B "$work/build-$processor" "${options[@]}"
  cmake --build "$work/build-$processor" --parallel "$JOBS"
  mkdir -p "$work/corpus/$processor"
  cp "$work/build-$processor"/*.so "$work/corpus/$processor"
done
python3 "$ROOT/tests/wheel/compare.py" "$work/corpus" "$work/native" "$work/emulated"
