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
# More checks than processors, because many wait. A group is for what must not run twice at a time.
[ -z "$where" ] || options+=(-n "$((JOBS + 1))" --dist loadgroup --no-loadscope-reorder)
exec "$checkers/pytest" "${options[@]}" "$@" ${where:+"$where"}
