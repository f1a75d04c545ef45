#!/usr/bin/env bash
# Builds the page, rtf and its hosts (optimised), and the libraries for programs of other frameworks.
#
# RTF_PAGE=none does not build the page, for machines without npm or network.

. "$(dirname "$0")/env.sh"

# Cargo compiles the crates with C code again if it changes, which is the case for each commit.
unset SOURCE_DATE_EPOCH

[ "${RTF_PAGE:-}" = none ] || tools/web.sh
# Without the generators of schemas and headers, which are used while the project is developed.
cargo build --release --locked --workspace --exclude xtask --bins
tools/preload.sh
