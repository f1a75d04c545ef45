#!/usr/bin/env bash
# Installs what the measurements need and this machine lacks, then measures what
# `make build` has built.
#
#   benches/run.sh [--only PATTERN] [--rounds N] [--json FILE] …    see --help

. "$(dirname "$0")/../tools/env.sh"

. tools/packages.sh

# Without these nothing is measured.
missing=()
have python3 || missing+=(python3)
have cc && have c++ || missing+=(g++)
have ctest || missing+=(cmake)
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"

# Without the peers, some lines are not.
if predecessor=$(tools/predecessor.sh); then
  export RTF_BENCH_PREDECESSOR=$predecessor
else
  say "warning: without robot-testing-framework 2.x its lines cannot be measured"
fi
if peers=$(tools/venv.sh bench); then
  export RTF_BENCH_PYTHON=$peers
else
  say "warning: without pytest its lines cannot be measured"
fi

exec python3 -B benches/bench.py "$@"
