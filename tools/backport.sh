#!/usr/bin/env bash
# Prints a directory of the user's cache with the files of a package of Debian's backports, which
# is not installed.
#
#   tools/backport.sh NAME-VERSION PACKAGE    the name of the directory, the package

. "$(dirname "$0")/env.sh"
. tools/packages.sh

directory=$CACHE/${1:?a directory}
package=${2:?a package}

# The archive from which the system gets its packages, which may be a mirror.
archive() {
  # shellcheck disable=SC2016 # apt-get's fields
  apt-get indextargets --format '$(RELEASE) $(REPO_URI)' 'Created-By: Packages' |
    sed -n 's/^bookworm //p' | head -n 1
}

# Downloads the package with separate package lists, so that the system's do not change.
unpack() {
  local archive work options
  archive=$(archive)
  [ -n "$archive" ] || die "$package is missing or too old, and this is not Debian 12" "install $package"
  work=$(mktemp -d "$directory.XXXXXX")
  # shellcheck disable=SC2064 # the value of now
  trap "rm -rf '$work'" EXIT
  mkdir -p "$work"/{lists/partial,cache/archives/partial,root}
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
    "$archive bookworm-backports main" >"$work/sources.list"
  options=(-o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts=-
    -o Dir::State::lists="$work/lists" -o Dir::Cache="$work/cache")
  quietly apt-get -qq "${options[@]}" update
  (cd "$work" && quietly apt-get -qq "${options[@]}" download "$package")
  dpkg-deb -x "$work/$package"_*.deb "$work/root"
  mv "$work/root/usr" "$directory"
}

mkdir -p "$CACHE"
exec 9>"$directory.lock"
flock 9
[ -e "$directory" ] || unpack
printf '%s\n' "$directory"
