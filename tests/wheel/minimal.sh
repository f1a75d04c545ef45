#!/usr/bin/env bash
# Installs a wheel with pip in a minimal Debian (tools/minimal_debian.sh) that has Python and no
# compiler, creates projects with `rtf new`, and runs them and other suites.
#
#   tests/wheel/minimal.sh WHEEL
#
# Needs root, or sudo without a password.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh
. tools/minimal_debian.sh

wheel=$(realpath "${1:?a wheel}")
become_root "$wheel"
work=$(mktemp -d)
debian=$work/debian
trap 'rm -rf --one-file-system "$work"' EXIT
need_base
unpack_base "$debian"
cp "$wheel" "$debian"
cp -R tests/install/downstream "$debian/project"

cat >"$debian/session.sh" <<'SESSION'
set -eux
export DEBIAN_FRONTEND=noninteractive
apt-get -qq update
apt-get install -qq -o Dpkg::Use-Pty=0 --no-install-recommends python3-venv
[ -z "$(command -v cc cmake)" ]
SECONDS=0
python3 -m venv /venv
/venv/bin/pip install --quiet --disable-pip-version-check --no-index /*.whl
echo "installed rtf in $SECONDS s"
export PATH=/venv/bin:$PATH
rtf doctor lua python ros2shm
for language in python lua; do
  rtf new suite --language $language $language-robot
  (cd $language-robot && rtf run .)
done
rtf run interpreted.xml
SESSION

started=$SECONDS
run_in_base "$debian" network /project /session.sh
say "in a minimal Debian: $((SECONDS - started)) s"
