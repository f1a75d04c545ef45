#!/usr/bin/env bash
# Tests the commands of README in a minimal Debian, see tools/minimal_debian.sh, on a clone of
# the last commit. Takes a quarter of an hour or more, so `make test` has only the bootstrap,
# tools/front_door.sh.
#
#   tests/install/fresh_machine.sh          make demo, and once more without a network
#   tests/install/fresh_machine.sh test     make test-quick
#
# Needs root, or sudo without a password.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh
. tools/minimal_debian.sh

goal=${1:-demo}
case $goal in
  demo | test) ;;
  *) die "no goal \`$goal\`: demo or test" ;;
esac
become_root "$@"
need_base
# Not in /tmp, which may be in memory: a release build is large.
work=$(mktemp -d --tmpdir="$CACHE" fresh-machine-XXXX)
debian=$work/debian
trap 'rm -rf --one-file-system "$work"' EXIT
unpack_base "$debian"
release_base
quietly git clone --depth 1 "file://$ROOT" "$debian/rtf"

run() {
  local started=$SECONDS
  say "\$ $2    ($1)"
  printf 'set -e\n%s\n' "$2" >"$debian/session.sh"
  run_in_base "$debian" "$1" /rtf /session.sh
  say "$2: $((SECONDS - started)) s"
}

case $goal in
  demo)
    run network 'make demo'
    run loopback 'make demo'
    ;;
  test) run network 'make test-quick' ;;
esac
