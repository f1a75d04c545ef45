#!/usr/bin/env bash
# Runs a command in namespaces in which programs of another processor run under qemu's user
# emulation. If root calls it, all users exist there; otherwise only the caller, as root.
#
#   tools/binfmt.sh PROCESSOR COMMAND ARGUMENT…
#
# Linux 6.7 or later has a table of interpreters for each user namespace (binfmt_misc), so the
# machine's is unchanged. qemu before 10 refuses to make a process a child subreaper, which rtf
# needs.

. "$(dirname "$0")/env.sh"

processor=${1:?a processor: aarch64}
shift
# An ELF file for 64 bits, little endian, executable or shared, of machine 183.
# shellcheck disable=SC2016 # the kernel's notation
[ "$processor" = aarch64 ] || die "no processor \`$processor\`: aarch64"
magic='\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00'
mask='\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff'
version=$("qemu-$processor-static" --version 2>/dev/null | sed -n 's/.*version \([0-9]*\).*/\1/p')
if [ "${version:-0}" -ge 10 ]; then
  qemu=$(command -v "qemu-$processor-static")
else
  qemu=$(tools/backport.sh qemu-10 qemu-user)/bin/qemu-$processor
fi

cd "$OLDPWD"

# Writes this process's users into the namespace that the process creates below.
map_users() {
  local process=$1 file
  while [ "$(readlink "/proc/$process/ns/user")" = "$(readlink /proc/self/ns/user)" ]; do
    sleep 0.01
  done
  for file in uid_map gid_map; do
    awk '{ print $1, $1, $3 }' "/proc/self/$file" >"/proc/$process/$file"
  done
}

users=(--map-root-user)
if [ "$(id -u)" -eq 0 ]; then
  users=()
  map_users $$ &
fi
# shellcheck disable=SC2016 # the inner shells expand that
exec unshare --user "${users[@]}" bash -euc '
  until read -r _ </proc/self/gid_map; do sleep 0.01; done 2>/dev/null
  exec unshare --mount --pid --fork --kill-child bash -euc "$@"' - '
  mount -t proc proc /proc
  mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc
  printf "%s" "$0" >/proc/sys/fs/binfmt_misc/register
  exec "$@"' ":qemu:M::$magic:$mask:$qemu:FP" "$@"
