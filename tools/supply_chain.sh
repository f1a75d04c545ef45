#!/usr/bin/env bash
# Checks what the project depends on: licences, sources and duplicate versions (deny.toml), and
# dependencies that no code uses.

. "$(dirname "$0")/env.sh"

deny=$(tools/cargo_tool.sh cargo-deny 0.20.2)
machete=$(tools/cargo_tool.sh cargo-machete 0.9.2)

# The licences of all platforms' crates are read, not only of those that a build needs.
quietly cargo fetch --locked
# `--offline` does not fetch the database of advisories, which is not checked. An entry in
# deny.toml that is not needed any more is an error, too.
PATH=$deny:$PATH cargo deny --offline --locked check \
  -D unnecessary-skip -D license-not-encountered -D license-exception-not-encountered \
  bans licenses sources
"$machete/cargo-machete" --with-metadata
