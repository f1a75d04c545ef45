#!/bin/sh
# Starts the program twice, as `mpiexec -n 2` does: both fail, or both pass.
program=$(dirname "$0")/descendants_test
"$program" "$@"
first=$?
"$program" "$@" || exit
exit $first
