#!/usr/bin/env bash
# Tests the Debian packages: two builds are identical, lintian reports no error, and in a minimal
# Debian (tools/minimal_debian.sh) a user installs them, runs a suite, builds a plug-in, replaces
# robot-testing-framework, and removes everything. The image of packaging/container is built and used.
#
# Needs `make build`, and root, or sudo without a password.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh
. tools/minimal_debian.sh

become_root "$@"
need_packages lintian debhelper dpkg-dev mmdebstrap
work=$(mktemp -d)
debian=$work/debian
checks=
cleanup() {
  [ -z "$checks" ] || wait "$checks" || true
  rm -rf --one-file-system "$work"
}
trap cleanup EXIT

SOURCE_DATE_EPOCH=$(time_of_commit)
export SOURCE_DATE_EPOCH

check_packages() {
  local package
  packaging/deb/build.sh "$work/again"
  for package in "$work/packages"/*.deb; do
    cmp "$package" "$work/again/$(basename "$package")"
  done
  lintian --allow-root --fail-on error "$work/packages"/*.deb
}

# Waits for what runs in the background, and prints its output.
finish_checks() {
  local status=0
  wait "$checks" || status=$?
  checks=
  cat "$work/checks.log"
  [ "$status" -eq 0 ] || die "$1"
}

# One processor builds and checks the packages, another one creates the base and uses it.
packaging/deb/build.sh "$work/packages" >"$work/checks.log" 2>&1 &
checks=$!
need_base
unpack_base "$debian"
finish_checks "the packages were not built"
check_packages >"$work/checks.log" 2>&1 &
checks=$!

cp -R "$work/packages" "$debian/packages"
cp -R tests/install/downstream "$debian/project"

cat >"$debian/session.sh" <<'SESSION'
set -eux
export DEBIAN_FRONTEND=noninteractive
install() {
  apt-get install -qq -o Dpkg::Use-Pty=0 "$@"
}
apt-get -qq update
# What Debian's science-robotics-dev brings.
install robot-testing-framework
robottestingframework-testrunner --version

SECONDS=0
install /packages/rtf_*.deb
echo "installed rtf in $SECONDS s"
[ -z "$(command -v cmake c++)" ]
rtf --version
rtf doctor lua python ruby ros2shm
rtf run interpreted.xml
python3 -c 'import rtf; assert rtf.__file__.startswith("/usr/lib/python3/dist-packages"), rtf.__file__'
for page in rtf rtf-run; do gzip --test "/usr/share/man/man1/$page.1.gz"; done
for page in README.md docs/images/live.png examples/07-levels/rtf.toml; do [ -s "/usr/share/doc/rtf/$page" ]; done

install --no-install-recommends /packages/rtf-dev_*.deb g++ cmake
cmake -S . -B build
cmake --build build
status=0
RTF_PLUGIN_PATH=build rtf run suite.xml >output.txt 2>&1 || status=$?
cat output.txt
[ "$status" -eq 1 ]
grep -F '4 tests in 1 suite' output.txt
grep -F '3 passed, 1 failed' output.txt

# The predecessor's names come from Debian's package until ours replaces it.
dpkg -S /usr/bin/robottestingframework-testrunner | grep '^robottestingframework-testrunner:'
install --allow-downgrades /packages/robot-testing-framework-compat_*.deb
dpkg -S /usr/bin/robottestingframework-testrunner | grep '^robot-testing-framework-compat:'
[ ! -e /usr/include/*/robottestingframework ]
RTF_PLUGIN_PATH=build robottestingframework-testrunner --suite suite.xml && exit 1
grep -q '^Test case CppTest passed!$' result.txt
for package in 'RobotTestingFramework 2 COMPONENTS DLL' 'RTF COMPONENTS DLL' rtf; do
  mkdir -p packages
  printf 'cmake_minimum_required(VERSION 3.16)\nproject(P LANGUAGES CXX)\nfind_package(%s REQUIRED)\n' \
    "$package" >packages/CMakeLists.txt
  cmake -S packages -B packages/build
done

# Nothing is left.
dpkg -L rtf rtf-dev robot-testing-framework-compat | sort -u >/files
dpkg --purge robot-testing-framework-compat rtf-dev rtf
left=$(while read -r file; do
  [ ! -e "$file" ] || [ -d "$file" ] || echo "$file"
done </files
find / -xdev \( -path /project -o -path /packages -o -path /proc -o -path /sys -o -path /dev \) -prune -o \
  \( -name rtf -o -name 'rtf[-.]*' -o -name 'robot-testing-framework-compat*' \) -print)
[ -z "$left" ]
SESSION

started=$SECONDS
run_in_base "$debian" network /project /session.sh
say "in a minimal Debian: $((SECONDS - started)) s"
finish_checks "two builds differ, or lintian found an error"

# An image for Kubernetes.
unpack_base "$work/image"
tests/install/container.sh "$work/packages" "$work/image"
