#!/bin/sh
# Cargo calls it as RUSTC_WORKSPACE_WRAPPER: compiles the libraries of the workspace with the counters
# of libFuzzer, for tools/fuzz.py. Other crates are compiled as always, and so are shared with tests.

rustc=$1
shift
case " $* " in
*' --crate-type lib '*)
  set -- "$@" -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares
  ;;
esac
exec "$rustc" "$@"
