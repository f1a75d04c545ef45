# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# Go, which may be in the user's cache. `go test` compiles the corpus.
: "${source:?}"
PATH=$(tools/go.sh):$PATH
setting PATH "$PATH"
for package in arm promises descendants; do
  (cd "$source/$package" && quietly go test -list . .)
done
