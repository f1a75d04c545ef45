#!/usr/bin/env bash
# Runs the checks below tests/ with pytest, and installs what they need.
#
#   tools/test.sh                           all, several in parallel
#   tools/test.sh quick                     without those that need middleware (ROS, YARP, …)
#   tools/test.sh tests/examples -k parks   these: files, directories and options of pytest
#   tools/test.sh tests/test_sources.py::test_shell     one, with its output
#
# It ends with the checks that failed, each as the command that repeats it, and the slowest ones.

. "$(dirname "$0")/env.sh"

tools/bootstrap.sh test
checkers=$(tools/venv.sh test)

# A compiler's cache with what other checkouts have compiled: dependencies, and files that have not changed. Its
# server ends with the tests.
sccache=$(tools/venv.sh sccache)/sccache
server=$(mktemp -d)
export SCCACHE_DIR=$CACHE/sccache SCCACHE_CACHE_SIZE=5G SCCACHE_IDLE_TIMEOUT=3600 SCCACHE_SERVER_UDS=$server/socket
trap '"$sccache" --stop-server >/dev/null 2>&1 || true; rm -rf "$server"' EXIT
if quietly "$sccache" --start-server; then
  export RUSTC_WRAPPER=$sccache CMAKE_C_COMPILER_LAUNCHER=$sccache CMAKE_CXX_COMPILER_LAUNCHER=$sccache
else
  say "the compiler's cache does not start: everything is compiled"
fi

options=()
if [ "${1:-}" = quick ]; then
  shift
  options=(-m 'not middleware')
fi
where=tests
for argument in "$@"; do
  case $argument in
    *::*) where='' options+=(-s) ;;
    tests | tests/* | */tests/*) where='' ;;
  esac
done
# More checks than processors, because most wait. A group is for what must not run twice at a time.
[ -z "$where" ] || options+=(-n "$((3 * JOBS))" --dist loadgroup --no-loadscope-reorder)
"$checkers/pytest" "${options[@]}" "$@" ${where:+"$where"}
