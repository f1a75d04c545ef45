#!/usr/bin/env bash
# Checks GitHub workflows, and the inputs that they give to actions in this repository, with
# actionlint. Its program is in the user's cache.
#
#   tools/actionlint.sh WORKFLOW…

. "$(dirname "$0")/env.sh"

version=1.7.12
dir=$CACHE/actionlint-$version
mkdir -p "$CACHE"
exec 9>"$dir.lock"
flock 9
if [ ! -x "$dir/actionlint" ]; then
  say "installing actionlint $version into $dir"
  PATH=$(tools/go.sh):$PATH
  GOBIN=$dir quietly go install "github.com/rhysd/actionlint/cmd/actionlint@v$version" ||
    die "go could not install actionlint"
fi
flock -u 9
"$dir/actionlint" -no-color "$@"
