#!/usr/bin/env bash
# Builds rtf, its hosts and the preloaded libraries in C for a processor and glibc 2.28, with Zig as
# the linker and the C compiler, and prints the directory of the programs.
#
#   tools/cross.sh x86_64|aarch64
#
# For another processor, Rust needs its standard library. If the Rust on PATH does not have
# it (`rustup target add`), Debian's Rust is used, which has it as a package.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

processor=${1:?processor: x86_64 or aarch64}
target=$processor-unknown-linux-gnu
unset SOURCE_DATE_EPOCH # as in tools/build.sh
case $processor in
  x86_64) architecture=amd64 ;;
  aarch64) architecture=arm64 ;;
  *) die "no processor \`$processor\`: x86_64 or aarch64" ;;
esac

# Sets RUSTC and CARGO to Debian's.
use_debian_rust() {
  local root=() known
  have dpkg || die "this Rust cannot compile for $target" "rustup target add $target"
  known=$(dpkg --print-architecture && dpkg --print-foreign-architectures)
  if ! grep -q -x "$architecture" <<<"$known"; then
    say "adding Debian's architecture $architecture; to undo: sudo dpkg --remove-architecture $architecture"
    [ "$(id -u)" -eq 0 ] || root=(sudo -n)
    "${root[@]}" dpkg --add-architecture "$architecture"
    apt update
  fi
  need_packages rustc-web cargo-web "libstd-rust-web-dev:$architecture"
  export RUSTC=/usr/bin/rustc CARGO=/usr/bin/cargo
}

[ -d "$(rustc --print target-libdir --target "$target")" ] || use_debian_rust

tools=$(tools/venv.sh cross)
[ "${RTF_PAGE:-}" = none ] || tools/web.sh
ZIG=$("$tools/python" -c 'import ziglang, pathlib; print(pathlib.Path(ziglang.__file__).with_name("zig"))')
# It would prefer the Python module.
export ZIG CARGO_ZIGBUILD_ZIG_PATH=$ROOT/tools/zig.sh CARGO_ZIGBUILD_PYTHON_PATH=/bin/false
PATH=$tools:$PATH "${CARGO:-cargo}" zigbuild --release --locked --target "$target.2.28" --bins \
  -p rtf -p rtf-host-native -p rtf-host-lua -p rtf-frameworks \
  -p rtf-host-signals -p rtf-host-faults >&2
programs=$TARGET/$target/release
CC="tools/zig.sh cc --target=$processor-linux-gnu.2.28" tools/preload.sh "$programs" "fork_server report"
printf '%s\n' "$programs"
