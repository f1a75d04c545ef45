#!/usr/bin/env bash
# Installs the middleware that a lesson and its tests need. What is there is left alone.
#
#   tools/middleware.sh NAME      one of the files in tools/middleware, without .sh
#
# Prints the variables that are needed to use it, one NAME=value a line; for many
# there are none. Everything else that is said goes to stderr.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

known=$(basename --suffix=.sh tools/middleware/*.sh | paste --serial --delimiters=' ')
name=${1:?name: one of $known}
[ -e "tools/middleware/$name.sh" ] || die "no middleware \`$name\`" "known are: $known"

# Two at once must not install or build the same.
mkdir -p "$CACHE"
exec 8>"$CACHE/middleware-$name.lock"
flock 8

# shellcheck source=/dev/null
. "tools/middleware/$name.sh"
