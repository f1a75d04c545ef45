# shellcheck shell=bash
# Catch2 3: the system's package if it is new enough, otherwise Debian's backport of it,
# unpacked in the user's cache.

# Downloads the package with separate package lists, so that the system's do not change.
unpack_backport() {
  local dir=$1 work options archive
  # The archive from which the system gets its packages, which may be a mirror.
  # shellcheck disable=SC2016 # apt-get's fields
  archive=$(apt-get indextargets --format '$(RELEASE) $(REPO_URI)' 'Created-By: Packages' |
    sed -n 's/^bookworm //p' | head -n 1)
  [ -n "$archive" ] || die "Catch2 3 is missing, and this is not Debian 12" \
    "install Catch2 3, for example the package libcatch2-dev"
  work=$(mktemp -d)
  mkdir -p "$work"/{lists/partial,cache/archives/partial,root}
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
    "$archive bookworm-backports main" >"$work/sources.list"
  options=(-o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts=-
    -o Dir::State::lists="$work/lists" -o Dir::Cache="$work/cache")
  quietly apt-get -qq "${options[@]}" update
  (cd "$work" && quietly apt-get -qq "${options[@]}" download libcatch2-dev)
  dpkg-deb -x "$work"/libcatch2-dev_*.deb "$work/root"
  mv "$work/root/usr" "$dir"
  rm -rf "$work"
}

need_packages g++
version=$(candidate_of libcatch2-dev)
if [ -n "$version" ]; then
  need_packages libcatch2-dev
  prefix=/usr
else
  prefix=$CACHE/catch2-3.7.1
  [ -e "$prefix/include/catch2/catch_all.hpp" ] || unpack_backport "$prefix"
fi
libraries=$(dirname "$(find "$prefix/lib" -name libCatch2.a -print -quit)")
cpp_programs -I"$prefix/include" -L"$libraries" -lCatch2Main -lCatch2
setting CMAKE_PREFIX_PATH "$prefix"
