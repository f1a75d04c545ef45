#!/usr/bin/env bash
# Prints the bin directory of a program from crates.io, which it installs into the user's cache if
# necessary.
#
#   tools/cargo_tool.sh NAME VERSION [OPTION …]     options of cargo install

. "$(dirname "$0")/env.sh"

name=${1:?name of a crate}
version=${2:?version}
shift 2
tool=$CACHE/$name-$version

# Only one process at a time may install it.
mkdir -p "$CACHE"
exec 9>"$tool.lock"
flock 9

if [ ! -x "$tool/bin/$name" ]; then
  say "installing $name $version into $tool"
  work=$(mktemp -d --tmpdir="$CACHE" "$name-build-XXXX")
  trap 'rm -rf "$work"' EXIT
  # A separate target directory: builds of rtf do not wait for it.
  CARGO_TARGET_DIR=$work quietly cargo install --locked --root "$tool" "$@" "$name@$version" ||
    die "cargo could not install $name $version"
fi
printf '%s\n' "$tool/bin"
