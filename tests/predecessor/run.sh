#!/usr/bin/env bash
# Compares rtf with its predecessor: installs rtf into a temporary directory, and builds
# tests/predecessor/project against it and against Debian's robot-testing-framework 2.x.
#
#   tests/predecessor/run.sh compare    verdicts of both, case by case
#   tests/predecessor/run.sh command    both command lines, option by option
#   tests/predecessor/run.sh ours       RTF 1.x, the web page, scripts in programs

. "$(dirname "$0")/../../tools/env.sh"

part=${1:?part: command, compare or ours}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

PREFIX=$work/prefix DESTDIR='' tools/install.sh
case $part in
  compare)
    predecessor=$(tools/predecessor.sh)
    python3 tests/predecessor/compare.py "$predecessor" "$work/prefix" "$work"
    ;;
  command)
    predecessor=$(tools/predecessor.sh)
    python3 -B tests/predecessor/command.py "$predecessor/usr" "$work/prefix"
    ;;
  ours) python3 tests/predecessor/ours.py "$work/prefix" "$work" ;;
  *) die "no part \`$part\`: command, compare or ours" ;;
esac
