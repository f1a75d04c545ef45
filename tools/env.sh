# shellcheck shell=bash
# What all scripts here share: where things are, and how they talk to people.
# To be sourced; it changes into the top of the checkout.

set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$ROOT"

# Whatever is downloaded stays out of the checkout and is shared between checkouts.
CACHE=${XDG_CACHE_HOME:-${HOME:?HOME is not set}/.cache}/rtf
BUILD=$ROOT/build
TARGET=${CARGO_TARGET_DIR:-$ROOT/target}
case $TARGET in
  /*) ;;
  *) TARGET=$ROOT/$TARGET ;;
esac
JOBS=$(getconf _NPROCESSORS_ONLN)
export ROOT CACHE BUILD TARGET JOBS

say() {
  printf '%s\n' "$*" >&2
}

die() {
  say "error: $1"
  shift
  for hint in "$@"; do
    say "hint: $hint"
  done
  exit 1
}

# Whether a command can be called.
have() {
  command -v "$1" >/dev/null 2>&1
}

# Runs a command quietly; what it printed is shown only when it fails.
quietly() {
  local log status=0
  log=$(mktemp)
  "$@" >"$log" 2>&1 </dev/null || status=$?
  if [ "$status" -ne 0 ]; then
    cat "$log" >&2
  fi
  rm -f "$log"
  return "$status"
}
