#!/usr/bin/env bash
# Installs the middleware that a lesson and its tests need, unless it is installed.
#
#   tools/middleware.sh NAME      one of the files in tools/middleware, without .sh
#
# Prints the exports that a shell needs to use it, often none:
#
#   eval "$(tools/middleware.sh yarp)"
#
# Messages go to stderr.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

known=$(basename --suffix=.sh tools/middleware/*.sh | paste --serial --delimiters=' ')
name=${1:?name: one of $known}
[ -e "tools/middleware/$name.sh" ] || die "no middleware \`$name\`" "known are: $known"

# Prints an export, quoted for a shell.
setting() {
  printf 'export %s=%q\n' "$1" "$2"
}

# Only one process at a time may install or build it.
mkdir -p "$CACHE"
exec 8>"$CACHE/middleware-$name.lock"
flock 8

# shellcheck source=/dev/null
. "tools/middleware/$name.sh"
