#!/usr/bin/env python3
"""Counts the results of `cargo test`, without the tests that end the process.

own.py DIRECTORY TEST…
"""

import json
import re
import subprocess
import sys
from collections import Counter

skipped = [word for test in sys.argv[2:] for word in ("--skip", test)]
done = subprocess.run(
    ["cargo", "test", "--offline", "--no-fail-fast", "--lib", "--bins", "--tests", "--", *skipped],
    cwd=sys.argv[1],
    stdout=subprocess.PIPE,
    text=True,
    check=False,
)
counts: Counter[str] = Counter()
words = {"passed": "passed", "failed": "failed", "ignored": "skipped"}
for line in re.findall("^test result: .*", done.stdout, re.MULTILINE):
    for number, word in re.findall("([0-9]+) (passed|failed|ignored)", line):
        counts[words[word]] += int(number)
print(json.dumps(counts))
