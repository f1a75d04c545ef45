#!/bin/sh
# Cargo calls it as RUSTC_WORKSPACE_WRAPPER: compiles the libraries of the workspace with the counters
# of libFuzzer and all checks of debug builds, for tools/fuzz.py. Other crates are compiled as always, so that
# those of the release build are used.

rustc=$1
shift
case " $* " in
*' --crate-type lib '*)
  set -- "$@" -Copt-level=2 -Ccodegen-units=16 -Cdebug-assertions=on -Coverflow-checks=on -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares
  ;;
esac
exec "$rustc" "$@"
