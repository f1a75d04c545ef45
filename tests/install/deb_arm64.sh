#!/usr/bin/env bash
# Tests the Debian packages for arm64: in a minimal Debian for arm64 under qemu
# (tools/minimal_debian.sh), a user installs them, runs suites, also one with a C++ plug-in, and
# removes everything. lintian reports no error. Not part of `make test`: it compiles rtf for
# arm64.
#
# Needs `make build`, and root, or sudo without a password.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh
. tools/minimal_debian.sh

become_root "$@"
need_packages lintian cmake
work=$(mktemp -d)
debian=$work/debian
trap 'rm -rf --one-file-system "$work"' EXIT

SOURCE_DATE_EPOCH=$(time_of_commit)
export SOURCE_DATE_EPOCH
packaging/deb/build.sh "$work/packages" arm64
lintian --allow-root --fail-on error "$work/packages"/*.deb

use_arm64
need_base
unpack_base "$debian"
mv "$work/packages" "$debian/packages"
cp -R tests/install/downstream "$debian/project"
cmake -S "$debian/project" -B "$work/build" -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
  -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ "-Drtf_DIR=$ROOT/sdk/cpp/cmake/rtf" \
  "-Drtf_EXECUTABLE=$TARGET/release/rtf"
cmake --build "$work/build"
mkdir "$debian/project/plugins"
cp "$work/build"/*.so "$debian/project/plugins"

cat >"$debian/session.sh" <<'SESSION'
set -eux
export DEBIAN_FRONTEND=noninteractive
[ "$(dpkg --print-architecture)" = arm64 ]
apt-get -qq update
SECONDS=0
apt-get install -qq -o Dpkg::Use-Pty=0 --no-install-recommends /packages/rtf_*_arm64.deb
echo "installed rtf under qemu in $SECONDS s"
rtf --version
rtf doctor lua dll
status=0
rtf run interpreted.xml || status=$?
[ "$status" -eq 2 ] # there is no Python

apt-get install -qq -o Dpkg::Use-Pty=0 --no-install-recommends python3
rtf doctor python ros2shm
rtf run interpreted.xml
status=0
RTF_PLUGIN_PATH=plugins rtf run suite.xml >output.txt 2>&1 || status=$?
cat output.txt
[ "$status" -eq 1 ]
grep -F '3 passed, 1 failed' output.txt

dpkg --purge rtf
[ ! -e /usr/share/rtf ] && [ ! -e /usr/libexec/rtf ] && [ ! -e /usr/share/doc/rtf ]
SESSION

started=$SECONDS
run_in_base "$debian" network /project /session.sh
say "in a minimal Debian for arm64: $((SECONDS - started)) s"
