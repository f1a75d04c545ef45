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

# Rust: the version that Cargo.toml asks for, and where it is.
RUST_VERSION=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)

# Whether a version is that of RUST_VERSION or later.
is_new_rust() {
  [[ $1 == [0-9]* ]] && printf '%s\n' "$RUST_VERSION" "${1%%-*}" | sort -V -C
}

# The version of the cargo or the rustc in a folder, or else on PATH; nothing when it does not run.
rust_version_of() {
  local words
  read -r -a words < <("${2:+$2/}$1" --version 2>/dev/null) || true
  printf '%s' "${words[1]:-}"
}

has_new_rust() {
  is_new_rust "$(rust_version_of cargo "$@")" && is_new_rust "$(rust_version_of rustc "$@")"
}

# Puts a Rust that is new enough on PATH. When the one that is there is not, that is the system's:
# its programs alone go before, so that nothing else in /usr/bin does.
use_rust() {
  local tool folder=$CACHE/rust-of-the-system
  if [[ $PATH != "$folder":* ]]; then
    ! has_new_rust || return 0
    has_new_rust /usr/bin || return
    export PATH=$folder:$PATH
    # rustup's programs call what these name.
    unset RUSTC RUSTDOC
  fi
  mkdir -p "$folder"
  for tool in cargo rustc rustdoc rustfmt cargo-fmt cargo-clippy clippy-driver; do
    [ ! -x "/usr/bin/$tool" ] || [ -L "$folder/$tool" ] || ln -sf "/usr/bin/$tool" "$folder/"
  done
  has_new_rust
}

# Scripts that a script calls find it on PATH.
if [ "${RTF_RUST_IS_CHOSEN:-}" != "$RUST_VERSION" ] && use_rust; then
  export RTF_RUST_IS_CHOSEN=$RUST_VERSION
fi
