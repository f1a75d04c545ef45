#!/usr/bin/env bash
# Prints the directory of Debian's robot-testing-framework 2.x, which contains usr/bin and
# usr/lib; downloads it if necessary.
#
# It is unpacked into the user's cache and not installed, so that the two packages cannot
# be confused. Each version of the packages has a separate directory.

. "$(dirname "$0")/env.sh"

wanted=(robottestingframework-testrunner librobottestingframework-dev)
libraries=(librobottestingframework2 librobottestingframework-{dll,lua,ruby}2)

have apt-get || die "robot-testing-framework 2.x comes from Debian or Ubuntu" \
  "this system has no apt-get"

# Its packages and their missing dependencies.
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
dir=$CACHE/robot-testing-framework-2-$key

# Only one process at a time may unpack it.
mkdir -p "$CACHE"
exec 9>"$dir.lock"
flock 9

# After an interrupted run, this file is missing.
if [ ! -e "$dir/complete" ]; then
  say "unpacking $(printf '%s\n' "$list" | tr '\n' ' ')in $dir"
  rm -rf "$dir"
  mkdir -p "$dir/packages"
  cd "$dir/packages"
  download() {
    # shellcheck disable=SC2086 # one word for each package
    quietly apt-get -o APT::Sandbox::User="$(id -un)" download $list
  }
  if ! download && [ -z "${RTF_LISTS_ARE_NEW:-}" ]; then
    # Outdated lists may name versions that are no longer available.
    "$ROOT/tools/bootstrap.sh" update
    RTF_LISTS_ARE_NEW=yes exec "$ROOT/tools/predecessor.sh"
  fi
  compgen -G 'librobottestingframework-dev_*.deb' >/dev/null ||
    die "apt-get could not download robot-testing-framework 2.x"
  for package in *.deb; do
    dpkg-deb -x "$package" "$dir"
  done
  touch "$dir/complete"
fi
printf '%s\n' "$dir"
