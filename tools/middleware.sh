#!/usr/bin/env bash
# Installs the middleware that a lesson and its tests need. What is there is left alone.
#
#   tools/middleware.sh NAME      one of the files in tools/middleware, without .sh
#
# Prints what a shell has to export to use it, often nothing:
#
#   eval "$(tools/middleware.sh yarp)"
#
# Everything else that is said goes to stderr.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

known=$(basename --suffix=.sh tools/middleware/*.sh | paste --serial --delimiters=' ')
name=${1:?name: one of $known}
[ -e "tools/middleware/$name.sh" ] || die "no middleware \`$name\`" "known are: $known"

# Tells a variable that is needed, quoted for a shell.
setting() {
  printf 'export %s=%q\n' "$1" "$2"
}

# Two at once must not install or build the same.
mkdir -p "$CACHE"
exec 8>"$CACHE/middleware-$name.lock"
flock 8

# shellcheck source=/dev/null
. "tools/middleware/$name.sh"
