#!/usr/bin/env bash
# Installs what the measurements need and this machine lacks, then measures what
# `make build` has built.
#
#   benches/run.sh [--only PATTERN] [--rounds N] [--json FILE] …    see --help

. "$(dirname "$0")/../tools/env.sh"

# Without these nothing is measured; without the peers, some lines are not.
find_missing() {
  missing=()
  have python3 || missing+=(python3)
  have cc && have c++ || missing+=(g++)
  have ctest || missing+=(cmake)
  have robottestingframework-testrunner || missing+=(robottestingframework-testrunner)
  [ -n "$(find /usr/include /usr/local/include -path '*/robottestingframework/TestCase.h')" ] ||
    missing+=(librobottestingframework-dev)
}

# As root, or by sudo; a password is asked for only where somebody can type it.
install_missing() {
  local root=()
  have apt-get || return 1
  if [ "$(id -u)" -ne 0 ]; then
    have sudo || return 1
    root=(sudo)
    [ -t 0 ] || root+=(-n)
  fi
  quietly "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update &&
    quietly "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get -qq install -y --no-install-recommends "${missing[@]}"
}

find_missing
if [ ${#missing[@]} -gt 0 ]; then
  say "installing: ${missing[*]}"
  install_missing || say "hint: by hand, as root: apt-get install ${missing[*]}"
  find_missing
fi
for package in "${missing[@]}"; do
  case $package in
    python3 | g++) die "$package is missing" "as root: apt-get install $package" ;;
    *) say "warning: without $package its lines cannot be measured" ;;
  esac
done

if peers=$(tools/venv.sh bench); then
  export RTF_BENCH_PYTHON=$peers
else
  say "warning: without pytest its lines cannot be measured"
fi

exec python3 -B benches/bench.py "$@"
