#!/usr/bin/env bash
# Prints a directory with Debian's Python and Lua modules for arm64, in the user's cache. Its
# packages are unpacked and not configured, so creating it needs no arm64 processor.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

need_packages mmdebstrap arch-test
release=$(. /etc/os-release && printf '%s' "$VERSION_CODENAME")
packages=bash,dash,coreutils,procps,libstdc++6,python3-minimal,python3,python3-venv,lua-socket
# shellcheck disable=SC2016 # apt-get fills that in
sources=$(apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' | sed -n 's/^Debian //p' | sort -u)
[ -n "$sources" ] || die "apt-get has no lists of Debian's packages" "sudo apt-get update"
key=$(printf '%s\n' "$release" "$sources" "$packages" | sha256sum | cut -c1-12)
directory=$CACHE/debian-arm64-$key

mkdir -p "$CACHE"
exec 9>"$directory.lock"
flock 9
if [ ! -e "$directory/complete" ]; then
  say "unpacking Debian $release for arm64 into $directory"
  rm -rf "$directory"
  apt-config dump Acquire | grep '::.*::' >"$directory.conf" || true
  quietly mmdebstrap --architectures=arm64 --variant=extract --include="$packages" \
    --aptopt="$directory.conf" "$release" "$directory" <<<"$sources" || die "mmdebstrap could not create it"
  touch "$directory/complete"
fi
printf '%s\n' "$directory"
