#!/usr/bin/env bash
# Zig for cargo-zigbuild, see tools/cross.sh. `zig cc` does not know the linker's option
# --export-dynamic-symbol (ziglang/zig#23730), with which rtf-host-lua exports Lua's symbols
# and no others. Zig's linker knows it: this script lets `zig cc -v` link without the option
# and print the linker's command, and runs that with the option.

set -euo pipefail

zig=${ZIG:?the program zig}
arguments=()
exported=()
output=
previous=
for argument in "$@"; do
  [ "$previous" != -o ] || output=$argument
  previous=$argument
  case $argument in
    -Wl,--export-dynamic-symbol=*) exported+=("${argument#-Wl,}") ;;
    *) arguments+=("$argument") ;;
  esac
done
[ ${#exported[@]} -gt 0 ] || exec "$zig" "$@"

log=$("$zig" "${arguments[@]}" -v 2>&1) || { printf '%s\n' "$log" >&2 && exit 1; }
read -r -a linker < <(grep '^ld\.lld ' <<<"$log" | tail -n 1) ||
  { printf 'error: zig printed no command of its linker:\n%s\n' "$log" >&2 && exit 1; }
exec "$zig" "${linker[@]}" "${exported[@]}" -o "$output"
