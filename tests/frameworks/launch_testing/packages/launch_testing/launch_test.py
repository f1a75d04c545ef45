"""Runs a file, and prints how many of its tests passed, failed and were skipped."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

from .loader import LoadTestsFromPythonModule
from .test_runner import LaunchTestRunner

# Only the numbers go to standard output.
output, sys.stdout = sys.stdout, sys.stderr
name = Path(sys.argv[1]).stem
spec = importlib.util.spec_from_file_location(name, sys.argv[1])
assert spec is not None and spec.loader is not None
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
runner = LaunchTestRunner(LoadTestsFromPythonModule(module, name=name), sys.argv[2:])
runner.validate()
counts = {"passed": 0, "failed": 0, "skipped": 0}
for result in runner.run().values():
    problems = [case for case, _ in [*result.failures, *result.errors]]
    failed = {getattr(case, "test_case", case).id() for case in problems}
    skipped = {case.id() for case, _ in result.skipped}
    for case in result.cases:
        is_failed, is_skipped = case.id() in failed, case.id() in skipped
        counts["failed" if is_failed else "skipped" if is_skipped else "passed"] += 1
print(json.dumps(counts), file=output)
