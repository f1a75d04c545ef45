#!/bin/sh
# Runs a program without rtf, and prints the numbers of tests in CppUnit's text report as
# JSON. The report counts a test with a failure and an error twice.
report=$("$@" 2>/dev/null)
all=$(echo "$report" | sed -n 's/^Run: *\([0-9]*\) .*/\1/p')
bad=$(echo "$report" | sed -n 's/^[0-9]*) test: \(.*\) ([EF]).*/\1/p' | sort -u | wc -l)
echo "{\"passed\": $((all - bad)), \"failed\": $bad}"
