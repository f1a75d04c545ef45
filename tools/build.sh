#!/usr/bin/env bash
# Builds the page, and rtf and its hosts, optimised.
#
# RTF_PAGE=none leaves the page as it is, for machines without npm or network.

. "$(dirname "$0")/env.sh"

[ "${RTF_PAGE:-}" = none ] || tools/web.sh
cargo build --release --locked --bins
