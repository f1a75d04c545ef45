# shellcheck shell=bash
# Paths, messages and Rust for all scripts. To be sourced; it changes into the root of
# the checkout.

set -euo pipefail

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$ROOT"

# Downloads are shared between checkouts.
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

# Whether a command exists.
have() {
  command -v "$1" >/dev/null 2>&1
}

# Runs a command and prints its output only if it fails.
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

# The Rust version that Cargo.toml requires.
RUST_VERSION=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)

# The version of rtf, for all packages.
version_of_rtf() {
  sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml
}

# The time of the last commit, in seconds since 1970: the timestamps of all packages. All files
# in a source archive have it.
time_of_commit() {
  if [ -n "${SOURCE_DATE_EPOCH:-}" ]; then
    printf '%s' "$SOURCE_DATE_EPOCH"
  elif [ -e .git ]; then
    git log -1 --format=%ct
  else
    stat --format=%Y Cargo.toml
  fi
}

# Whether a version is RUST_VERSION or later.
is_new_rust() {
  [[ $1 == [0-9]* ]] && printf '%s\n' "$RUST_VERSION" "${1%%-*}" | sort -V -C
}

# The version of cargo or rustc in a directory, or on PATH; empty if it does not run.
rust_version_of() {
  local words
  read -r -a words < <("${2:+$2/}$1" --version 2>/dev/null) || true
  printf '%s' "${words[1]:-}"
}

has_new_rust() {
  is_new_rust "$(rust_version_of cargo "$@")" && is_new_rust "$(rust_version_of rustc "$@")"
}

# Puts a Rust that is new enough on PATH. If the first one on PATH is too old, links to the
# system's Rust are put before it; other programs of /usr/bin are not.
use_rust() {
  local tool dir=$CACHE/rust-of-the-system
  if [[ $PATH != "$dir":* ]]; then
    ! has_new_rust || return 0
    has_new_rust /usr/bin || return
    export PATH=$dir:$PATH
    # rustup's programs would use these.
    unset RUSTC RUSTDOC
  fi
  mkdir -p "$dir"
  for tool in cargo rustc rustdoc rustfmt cargo-fmt cargo-clippy clippy-driver; do
    [ ! -x "/usr/bin/$tool" ] || [ -L "$dir/$tool" ] || ln -sf "/usr/bin/$tool" "$dir/"
  done
  has_new_rust
}

# Scripts that a script calls inherit PATH.
if [ "${RTF_RUST_IS_CHOSEN:-}" != "$RUST_VERSION" ] && use_rust; then
  export RTF_RUST_IS_CHOSEN=$RUST_VERSION
fi
