#!/usr/bin/env bash
# Builds the wheel for pip into build/wheel, see packaging/wheel and docs/decisions. Prints
# its path.
#
#   tools/wheel.sh                   the programs of target/release, for this machine
#   tools/wheel.sh x86_64|aarch64    for all Linux systems with glibc 2.28 or later

. "$(dirname "$0")/env.sh"

processor=${1:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=$(tools/venv.sh wheel)

case $processor in
  '') platform=linux_$(uname -m) ;;
  x86_64 | aarch64)
    platform=manylinux_2_28_$processor
    PROGRAMS=$(tools/cross.sh "$processor")
    export PROGRAMS
    ;;
  *) die "no processor \`$processor\`: x86_64 or aarch64" ;;
esac

DESTDIR=$work PREFIX=/prefix tools/install.sh
rm "$work/prefix/share/rtf/manifest.txt" # pip has its own list
cp packaging/wheel/* Cargo.toml LICENSE "$work"

# pip can uninstall all files only if the wheel has no others, such as byte code.
[ -z "$(find "$work" -name __pycache__)" ] || die "there is byte code in the staged files"

mkdir -p "$BUILD/wheel"
(cd "$work" && WHEEL_PLATFORM=$platform PYTHONDONTWRITEBYTECODE=1 SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-1580601600} \
  quietly "$tools/hatchling" build --target wheel --directory "$work/dist")
wheel=$(basename "$work"/dist/*.whl)
mv "$work/dist/$wheel" "$BUILD/wheel/$wheel"

if [ -n "$processor" ]; then
  shown=$("$(tools/venv.sh cross)/auditwheel" show "$BUILD/wheel/$wheel")
  # Not the tag in the file's name; there is no such line if a library is not allowed.
  glibc=$(tr '\n' ' ' <<<"$shown" | sed -n 's/.*is consistent with the following platform tag: "manylinux_2_\([0-9]*\)_.*/\1/p')
  [ "${glibc:-99}" -le 28 ] || die "the programs need a newer glibc than 2.28" "$shown"
fi
printf '%s\n' "$BUILD/wheel/$wheel"
