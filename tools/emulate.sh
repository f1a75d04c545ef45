#!/usr/bin/env bash
# Runs a command in a root directory of another processor, under qemu's user emulation, see
# tools/binfmt.sh.
#
#   tools/emulate.sh ROOT PROCESSOR COMMAND ARGUMENT…
#
# The working directory, /tmp and the checkout are the same inside.

. "$(dirname "$0")/env.sh"

guest=${1:?a root directory}
processor=${2:?a processor: aarch64}
shift 2
cd "$OLDPWD"
# shellcheck disable=SC2016 # the inner shell expands that
exec "$ROOT/tools/binfmt.sh" "$processor" bash -euc '
  guest=$0
  checkout=$1
  here=$PWD
  shift
  mount -t proc proc "$guest/proc"
  for dir in /dev /sys /tmp "$checkout"; do
    mkdir -p "$guest$dir"
    mount --rbind "$dir" "$guest$dir"
  done
  exec /usr/sbin/chroot "$guest" /usr/bin/env --chdir="$here" "$@"' "$guest" "$ROOT" "$@"
