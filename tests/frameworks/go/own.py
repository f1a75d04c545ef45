#!/usr/bin/env python3
"""Counts the results of `go test` for all tests that do not end the process.

own.py DIRECTORY
"""

import json
import subprocess
import sys
from collections import Counter

WORDS = {"pass": "passed", "fail": "failed", "skip": "skipped"}

# Go 1.19 of Debian 12 has no `-skip`.
listed = subprocess.run(
    ["go", "test", "-list", "."],
    cwd=sys.argv[1],
    stdout=subprocess.PIPE,
    text=True,
    check=True,
)
tests = [line for line in listed.stdout.splitlines() if " " not in line and "\t" not in line]
safe = "|".join(test for test in tests if "Fatal" not in test)
done = subprocess.run(
    ["go", "test", "-json", "-count=1", f"-run=^({safe})$"],
    cwd=sys.argv[1],
    stdout=subprocess.PIPE,
    text=True,
    check=False,
)
events = [json.loads(line) for line in done.stdout.splitlines()]
ends = {
    event["Test"]: WORDS[event["Action"]]
    for event in events
    if "Test" in event and event["Action"] in WORDS
}
leaves = [test for test in ends if not any(other.startswith(f"{test}/") for other in ends)]
print(json.dumps(Counter(ends[test] for test in leaves)))
