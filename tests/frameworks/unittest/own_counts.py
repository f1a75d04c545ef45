"""Runs unittest's own runner, and prints how many tests passed, failed and were skipped."""

import json
import sys
import unittest

# Only the numbers go to standard output.
output, sys.stdout = sys.stdout, sys.stderr
result = unittest.main(module=None, argv=["unittest", *sys.argv[1:]], exit=False).result


def ids(tests):
    """The tests; a subtest belongs to its test, and functions of a class are no tests."""
    tests = [getattr(test, "test_case", test) for test in tests]
    return {test.id() for test in tests if isinstance(test, unittest.TestCase)}


problems = [test for test, _ in result.failures + result.errors]
failed = ids(problems + result.unexpectedSuccesses)
whole = [test for test, _ in result.skipped if not hasattr(test, "test_case")]
skipped = ids(whole + [test for test, _ in result.expectedFailures]) - failed
passed = result.testsRun - len(failed) - len(skipped)
print(json.dumps({"passed": passed, "failed": len(failed), "skipped": len(skipped)}), file=output)
