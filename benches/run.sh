#!/usr/bin/env bash
# Installs missing requirements, then measures the result of `make build`.
#
#   benches/run.sh [--only PATTERN] [--rounds N] [--json FILE] …    see --help

. "$(dirname "$0")/../tools/env.sh"

. tools/packages.sh

# Required for all measurements.
missing=()
have python3 || missing+=(python3)
have cc && have c++ || missing+=(g++)
have ctest || missing+=(cmake)
[ -e /usr/include/gtest/gtest.h ] || missing+=(libgtest-dev)
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"

# Peers, required for some lines.
if predecessor=$(tools/predecessor.sh); then
  export RTF_BENCH_PREDECESSOR=$predecessor
else
  say "warning: robot-testing-framework 2.x is missing; its lines will not be measured"
fi
if peers=$(tools/venv.sh bench); then
  export RTF_BENCH_PYTHON=$peers
else
  say "warning: pytest is missing; its lines will not be measured"
fi
if episodes=$(tools/venv.sh episodes); then
  export RTF_BENCH_EPISODES=$episodes
else
  say "warning: Gymnasium and MuJoCo are missing; their lines will not be measured"
fi

# Without them, Python keeps compiled modules, as it does for most users. pip has compiled
# those of the peers in any case.
unset PYTHONDONTWRITEBYTECODE PYTHONUNBUFFERED

exec python3 -B benches/bench.py "$@"
