#!/bin/sh
# Runs a harness without rtf, and prints the numbers of routines in AUnit's text report as
# JSON. The report lists each failure of a routine.
report=$("$@" 2>/dev/null)
count() {
  echo "$report" | grep -E "$1" | sort -u | wc -l
}
bad=$(count '^(FAIL|ERROR) ')
echo "{\"passed\": $(echo "$report" | grep -c '^OK '), \"failed\": $bad}"
