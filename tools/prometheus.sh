#!/usr/bin/env bash
# Prints the directory of `prometheus` and `promtool`, which are those of Debian's package. The package is
# unpacked in the user's cache, because installing it starts a service.

. "$(dirname "$0")/env.sh"
# shellcheck source=tools/packages.sh
. tools/packages.sh

have apt-get || die "prometheus is unpacked from Debian's package, and there is no apt-get"
version=$(candidate_of prometheus)
if [ -z "$version" ]; then
  apt update || die "apt-get could not update its lists" "as root: apt-get update"
  version=$(candidate_of prometheus)
fi
[ -n "$version" ] || die "apt-get has no package \`prometheus\`"
dir=$CACHE/prometheus-${version//[^A-Za-z0-9.]/-}

# Only one process at a time may unpack it.
mkdir -p "$CACHE"
exec 9>"$dir.lock"
flock 9

if [ ! -e "$dir/complete" ]; then
  say "unpacking prometheus $version into $dir"
  rm -rf "$dir"
  mkdir -p "$dir"
  # apt-get as root cannot give files in a home directory to its own user.
  (cd "$dir" && quietly apt-get -qq -o APT::Sandbox::User=root download prometheus) ||
    die "the package \`prometheus\` could not be downloaded"
  dpkg-deb --extract "$dir"/*.deb "$dir"
  rm "$dir"/*.deb
  touch "$dir/complete"
fi
printf '%s\n' "$dir/usr/bin"
