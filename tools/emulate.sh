#!/usr/bin/env bash
# Runs a command in a root directory of another processor, under qemu's user emulation.
#
#   tools/emulate.sh ROOT PROCESSOR COMMAND ARGUMENT…
#
# The working directory, /tmp and the checkout are the same inside. Linux 6.7 or later has a
# table of interpreters for each user namespace (binfmt_misc), so the machine's is unchanged.

. "$(dirname "$0")/env.sh"

guest=${1:?a root directory}
processor=${2:?a processor: aarch64}
shift 2
cd "$OLDPWD"
qemu=$(command -v "qemu-$processor-static") || die "qemu-$processor-static is missing" "apt-get install qemu-user-static"
# An ELF file for 64 bits, little endian, executable or shared, of machine 183.
# shellcheck disable=SC2016 # the kernel's notation
[ "$processor" = aarch64 ] || die "no processor \`$processor\`: aarch64"
export magic='\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00'
export mask='\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff'
export guest qemu

# shellcheck disable=SC2016 # the inner shell expands that
exec unshare --user --map-root-user --mount --pid --fork --kill-child bash -euc '
  mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc
  printf "%s" ":qemu:M::$magic:$mask:$qemu:FP" >/proc/sys/fs/binfmt_misc/register
  mount -t proc proc "$guest/proc"
  for dir in /dev /sys /tmp "$ROOT"; do
    mkdir -p "$guest$dir"
    mount --rbind "$dir" "$guest$dir"
  done
  here=$PWD
  unset guest qemu magic mask
  exec chroot "$0" /usr/bin/env --chdir="$here" "$@"' "$guest" "$@"
