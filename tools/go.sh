#!/usr/bin/env bash
# Prints the bin directory of a Go that can build the programs of the tests: the machine's, or
# else one from a virtual environment in the user's cache, see tools/venv.sh. Debian 12 has Go 1.19.

. "$(dirname "$0")/env.sh"

# The newest version that a module in tests/ requires.
required=$(sed -n 's/^go //p' tests/{telemetry,telemetry/collector,executors/control_plane}/go.mod | sort -V | tail -n 1)
version=$(go env GOVERSION 2>/dev/null || true)

if [ -n "$version" ] && printf 'go%s\n' "$required" "${version#go}" | sort -V -C; then
  dirname "$(command -v go)"
else
  environment=$(dirname "$(tools/venv.sh go)")
  printf '%s\n' "$environment"/lib/python3*/site-packages/go/bin
fi
