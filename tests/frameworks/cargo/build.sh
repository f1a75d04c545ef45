# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# The cargo that builds rtf; the corpus has no dependencies.
need_packages g++
setting CARGO_TARGET_DIR "$out/target"
for package in arm silent promises descendants; do
  quietly env CARGO_TARGET_DIR="$out/target" cargo test --offline --no-run \
    --manifest-path "$source/$package/Cargo.toml"
done
