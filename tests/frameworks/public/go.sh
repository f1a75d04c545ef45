#!/usr/bin/env bash
# Runs the tests of a public Go module with `go test` and with rtf, and compares the results
# of all tests and subtests.
#
#   tests/frameworks/public/go.sh RTF

. "$(dirname "$0")/../../../tools/env.sh"

rtf=${1:?program: rtf}
module=github.com/spf13/pflag
version=v1.0.10

PATH=$(tools/go.sh):$PATH
out=$BUILD/frameworks/public-go
rm -rf "$out"
mkdir -p "$out"
sources=$(cd "$out" && GOWORK=off go mod download -json "$module@$version" |
  python3 -c 'import json, sys; print(json.load(sys.stdin)["Dir"])')
cp -r "$sources" "$out/pflag"
chmod -R u+w "$out/pflag"
RTF_PLUGIN_PATH=$out python3 tests/frameworks/public/go.py "$rtf" "$out/pflag"
