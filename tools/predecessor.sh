#!/usr/bin/env bash
# Prints the folder of Debian's robot-testing-framework 2.x, with usr/bin and
# usr/lib in it; downloads it when it is not there.
#
# It is unpacked into the user's cache and never installed, so that our package
# and this one cannot be taken for each other; whether it is installed, too, does
# not matter. The key is made of the packages' versions: another version is
# another folder.

. "$(dirname "$0")/env.sh"

wanted=(robottestingframework-testrunner librobottestingframework-dev)
libraries=(librobottestingframework2 librobottestingframework-{dll,lua,ruby}2)

have apt-get || die "robot-testing-framework 2.x comes from Debian or Ubuntu" \
  "this system has no apt-get"

# Its own packages, and of others what they need and this machine lacks.
packages() {
  apt-get install --simulate --reinstall --no-install-recommends \
    "${wanted[@]}" "${libraries[@]}" 2>/dev/null |
    sed -n -E 's/^Inst ([^ ]+) .*\(([^ ]+) .*\[([^] ]+)\].*/\1=\2/p'
}

list=$(packages)
if [ -z "$list" ]; then
  tools/bootstrap.sh update
  list=$(packages)
fi
[[ $list == *librobottestingframework-dev=* ]] ||
  die "apt-get does not know librobottestingframework-dev" \
    "add Debian's main, or Ubuntu's main and universe, to its sources"

key=$(printf '%s\n' "$list" | sort | sha256sum | cut -c1-12)
folder=$CACHE/robot-testing-framework-2-$key

# Two at once must not unpack it twice.
mkdir -p "$CACHE"
exec 9>"$folder.lock"
flock 9

# Half a folder, left by an interrupted run, lacks this file.
if [ ! -e "$folder/complete" ]; then
  say "unpacking $(printf '%s\n' "$list" | tr '\n' ' ')in $folder"
  rm -rf "$folder"
  mkdir -p "$folder/packages"
  cd "$folder/packages"
  download() {
    # shellcheck disable=SC2086 # one word for each package
    quietly apt-get -o APT::Sandbox::User="$(id -un)" download $list
  }
  if ! download && [ -z "${RTF_LISTS_ARE_NEW:-}" ]; then
    # The lists may name versions that are not offered any more.
    "$ROOT/tools/bootstrap.sh" update
    RTF_LISTS_ARE_NEW=yes exec "$ROOT/tools/predecessor.sh"
  fi
  compgen -G 'librobottestingframework-dev_*.deb' >/dev/null ||
    die "apt-get could not download robot-testing-framework 2.x"
  for package in *.deb; do
    dpkg-deb -x "$package" "$folder"
  done
  touch "$folder/complete"
fi
printf '%s\n' "$folder"
