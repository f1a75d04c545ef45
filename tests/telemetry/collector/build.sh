#!/usr/bin/env bash
# Prints the path of an OpenTelemetry collector, which it builds if necessary. It is in the user's cache, because
# building it takes minutes; its name has a hash of its sources, which contain the versions of its modules.

. "$(dirname "$0")/../../../tools/env.sh"

PATH=$(tools/go.sh):$PATH
cd tests/telemetry/collector
key=$({ go version && cat go.mod go.sum main.go; } | sha256sum | cut -c1-12)
collector=$CACHE/otel-collector-$key

# Only one process at a time may build it.
mkdir -p "$CACHE"
exec 9>"$collector.lock"
flock 9

if [ ! -e "$collector" ]; then
  say "building $collector"
  GOTOOLCHAIN=local quietly go build -o "$collector.new" . || die "the collector could not be built"
  mv "$collector.new" "$collector"
fi
printf '%s\n' "$collector"
