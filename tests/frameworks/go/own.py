#!/usr/bin/env python3
"""Counts the results of `go test` for all tests that do not end the process.

own.py DIRECTORY
"""

import json
import subprocess
import sys
from collections import Counter

WORDS = {"pass": "passed", "fail": "failed", "skip": "skipped"}

done = subprocess.run(
    ["go", "test", "-json", "-count=1", "-skip=Fatal"],
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
