#!/usr/bin/env bash
# Measures which lines of the core the tests of the workspace run, and prints the share of each crate.
#
#   tools/coverage.sh [OPTION …]     options of `cargo llvm-cov report`, for example `--html`
#
# The programs that the end-to-end tests start are measured, too. A process that is killed records nothing.

. "$(dirname "$0")/env.sh"
# shellcheck source=tools/packages.sh
. tools/packages.sh

# Of the LLVM that rustc contains.
llvm=$(rustc --version --verbose | sed -n 's/^LLVM version: \([0-9]*\).*/\1/p')
have "llvm-profdata-$llvm" || install_packages "llvm-$llvm"
tool=$(tools/cargo_tool.sh cargo-llvm-cov 0.9.1)
export PATH=$tool:$PATH LLVM_COV=llvm-cov-$llvm LLVM_PROFDATA=llvm-profdata-$llvm
# A process that is killed while it writes its profile damages it.
export LLVM_PROFDATA_FLAGS=--failure-mode=all

# The end-to-end tests build further programs, which have to be measured as well.
export CARGO_TARGET_DIR=$TARGET/coverage
settings=$(cargo llvm-cov show-env --sh 2>/dev/null)
eval "$settings"
cargo llvm-cov clean --workspace
cargo build --quiet --workspace --locked
tests=0
# With nohup, SIGHUP would be ignored in the programs that the tests start.
env --default-signal=HUP cargo test --quiet --workspace --locked --no-fail-fast || tests=$?

if [ $# -gt 0 ]; then
  cargo llvm-cov report "$@"
else
  cargo llvm-cov report --json --summary-only | python3 tools/coverage.py
fi
exit "$tests"
