#!/usr/bin/env bash
# Runs the scenarios of conformance/ with GCC's sanitizers in C++ plug-ins, and with valgrind around the hosts for
# C++ and Lua. Each scenario must have its usual result, and there must be no report.
#
#   tools/sanitizers.sh [NAME]     only the tests whose names contain NAME, for example `address`

. "$(dirname "$0")/env.sh"
# shellcheck source=tools/packages.sh
. tools/packages.sh

have valgrind || install_packages valgrind
for library in libasan libubsan libtsan; do
  case $(c++ -print-file-name=$library.so) in
    /*) ;;
    *) die "the compiler has no $library" ;;
  esac
done

# All crates, although one is tested: with the features of all of them, as other tests build them.
cargo test --locked --workspace --test e2e -- --ignored "${1:-conformance::checkers}"
