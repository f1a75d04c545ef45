#!/usr/bin/env bash
# Builds rtf and its hosts, optimised.

. "$(dirname "$0")/env.sh"

cargo build --release --locked --bins
