#!/usr/bin/env bash
# Kills fixtures, hosts and runners at random moments, for half an hour.
# Each run prints its seed; RTF_CHAOS_SEED=N repeats its random numbers.

. "$(dirname "$0")/env.sh"

export RTF_CHAOS_SUITES=3000 RTF_CHAOS_RUNS=1000 RTF_CHAOS_ROUNDS=50
cargo test --workspace --test e2e -- \
  --nocapture chaos guard::a_runner_killed_at_any_moment \
  parallel_suites::twenty_suites parallel_suites::a_runner_killed_at_any_moment
