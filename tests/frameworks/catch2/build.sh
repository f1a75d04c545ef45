# shellcheck shell=bash
# Catch2 3: the system's package if it is new enough, otherwise Debian's backport of it,
# unpacked in the user's cache.

need_packages g++
version=$(candidate_of libcatch2-dev)
if [ -n "$version" ]; then
  need_packages libcatch2-dev
  prefix=/usr
else
  prefix=$(tools/backport.sh catch2-3.7.1 libcatch2-dev)
fi
libraries=$(dirname "$(find "$prefix/lib" -name libCatch2.a -print -quit)")
cpp_programs -I"$prefix/include" -L"$libraries" -lCatch2Main -lCatch2
setting CMAKE_PREFIX_PATH "$prefix"
