#!/usr/bin/env bash
# Builds the page, and rtf and its hosts, optimised, and the library for CppUnit.
#
# RTF_PAGE=none does not build the page, for machines without npm or network.

. "$(dirname "$0")/env.sh"

[ "${RTF_PAGE:-}" = none ] || tools/web.sh
cargo build --release --locked --bins
tools/cppunit.sh
