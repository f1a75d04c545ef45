# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# The Go of the system; any version that reads go.mod of the corpus. `go test` compiles it.
: "${source:?}"
have go || need_packages golang-go
(cd "$source/arm" && quietly go test -list . .)
