#!/usr/bin/env bash
# Tests the bootstrap in a minimal Debian, see tools/minimal_debian.sh: an old Rust stays,
# Debian's is used. tests/install/fresh_machine.sh runs the whole `make demo`.
#
# Needs root, or sudo without a password.

. "$(dirname "$0")/env.sh"
. tools/packages.sh
. tools/minimal_debian.sh

become_root "$@"
need_base
work=$(mktemp -d)
debian=$work/debian
trap 'rm -rf --one-file-system "$work"' EXIT
unpack_base "$debian"
mkdir "$debian/checkout"
git ls-files -z --cached --others --exclude-standard | tar -c --null --files-from=- | tar -x -C "$debian/checkout"
# An old Rust, as on a machine of a user who installed it long ago.
mkdir -p "$debian/old/bin"
for tool in cargo rustc; do
  printf '#!/bin/sh\necho "%s 1.63.0 (old)"\n' "$tool" >"$debian/old/bin/$tool"
  chmod +x "$debian/old/bin/$tool"
done

cat >"$debian/session.sh" <<'SESSION'
set -eux
[ -z "$(command -v cc cargo python3 cmake)" ]

# If no package is new enough, bootstrap prints one error and installs nothing.
sed -i.bak 's/^rust-version = .*/rust-version = "99.0"/' Cargo.toml
dpkg --list >../before
! PATH=/old/bin:$PATH tools/bootstrap.sh demo 2>../messages || exit 1
dpkg --list | cmp - ../before
cat ../messages
grep -x 'error: cargo 99.0 or later is missing, this is 1.63.0' ../messages
grep -x 'hint: this system has no package of it: .*rustup.rs.*' ../messages
mv Cargo.toml.bak Cargo.toml

# Debian's Rust is installed next to the old one and takes precedence.
PATH=/old/bin:$PATH tools/bootstrap.sh demo
/old/bin/cargo --version | grep -F 1.63.0
for path in "$PATH" "/old/bin:$PATH"; do
  PATH=$path bash -c '. tools/env.sh; has_new_rust; cargo --version; rustc --print sysroot'
done
# A second bootstrap finds everything and prints nothing.
[ -z "$(tools/bootstrap.sh demo 2>&1)" ]
[ -z "$(tools/bootstrap.sh build 2>&1)" ]
# The installed packages can compile, link, and create a virtual environment.
printf 'fn main() {}\n' >/tmp/a.rs && bash -c '. tools/env.sh; rustc -o /tmp/a /tmp/a.rs' && /tmp/a
python3 -m venv /tmp/venv && /tmp/venv/bin/pip --version
SESSION

started=$SECONDS
run_in_base "$debian" network /checkout /session.sh
say "the bootstrap: $((SECONDS - started)) s"
