"""Runs unittest's tests for the host: `python3 -m rtf.frameworks.unittest_runner FILE_OR_DIR`.

It discovers tests as `python3 -m unittest discover` does, and reports them to the host, or
lists them. Without a host, it is unittest's own runner.
"""

from __future__ import annotations

import argparse
import glob
import os
import sys
import unittest
import warnings

from rtf import session as rtf_session
from rtf.frameworks import stack_dump
from rtf.frameworks.connection import Connection
from rtf.frameworks.listing import Listing
from rtf.frameworks.unittest_result import Reporter
from rtf.frameworks.unittest_tests import import_problem, leaves, retain, start

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

# In tracebacks, unittest omits the frames of modules with this name.
__unittest = True

_FAILED_IMPORT = "unittest.loader._FailedTest."


def main() -> int:
    """Run or list the tests; the exit code is 1 after a problem."""
    options = _parser().parse_args()
    stack_dump.prepare()
    listing = Listing.from_environment()
    connection = Connection.from_environment()
    loader = unittest.TestLoader()
    suite = _discover(loader, options)
    if listing is not None:
        _list(listing, suite, loader.errors)
        return 0
    if connection is None:
        runner = unittest.TextTestRunner(
            failfast=options.failfast, buffer=options.buffer, tb_locals=options.locals
        )
        return int(not runner.run(suite).wasSuccessful())
    # A crash must not lose output.
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    reporter = Reporter(connection, rtf_session.connect(connection))
    reporter.failfast, reporter.buffer = options.failfast, options.buffer
    reporter.tb_locals = options.locals
    return _run(reporter, suite, loader.errors)


def _parser() -> argparse.ArgumentParser:
    """Return a parser for those of unittest's options that make sense here."""
    parser = argparse.ArgumentParser(prog="rtf.frameworks.unittest_runner")
    parser.add_argument("path", help="a file, or a directory to search for tests")
    parser.add_argument("-p", "--pattern", default="test*.py", help="of files with tests")
    parser.add_argument("-t", "--top-level-directory", help="of the project")
    parser.add_argument("-k", dest="names", action="append", help="only tests with this name")
    parser.add_argument("-f", "--failfast", action="store_true", help="stop at a failure")
    parser.add_argument("-b", "--buffer", action="store_true", help="buffer output")
    parser.add_argument("--locals", action="store_true", help="show local variables")
    parser.add_argument("-v", "--verbose", action="store_true", help="no effect")
    parser.add_argument("-q", "--quiet", action="store_true", help="no effect")
    return parser


def _discover(loader: unittest.TestLoader, options: argparse.Namespace) -> unittest.TestSuite:
    if options.names:
        loader.testNamePatterns = [name if "*" in name else f"*{name}*" for name in options.names]
    path, pattern = options.path, options.pattern
    if os.path.isfile(path):
        path, name = os.path.split(os.path.abspath(path))
        pattern = glob.escape(name)
        if not name.endswith(".py") or not name[:-3].isidentifier():
            sys.exit(f"`{name}` cannot be imported: the name of a module is an identifier")
    return loader.discover(path, pattern, options.top_level_directory)


def _list(listing: Listing, suite: unittest.TestSuite, problems: Iterable[object]) -> None:
    for problem in problems:
        listing.problem("\n".join(import_problem(str(problem))))
    for test in leaves(suite):
        if not test.id().startswith(_FAILED_IMPORT):
            listing.case(start(test))
    listing.finish()


def _run(reporter: Reporter, suite: unittest.TestSuite, problems: Iterable[object]) -> int:
    for problem in problems:
        reporter.report_import_problem(str(problem))
    runs = reporter.plan(
        [test for test in leaves(suite) if not test.id().startswith(_FAILED_IMPORT)]
    )
    retain(suite, lambda test: runs.get(test.id(), False))
    with warnings.catch_warnings():
        if not sys.warnoptions:
            warnings.simplefilter("default")
        try:
            suite(reporter)
        except reporter.STOPPED:
            return 1
    reporter.finish()
    return int(bool(problems) or not reporter.wasSuccessful())


if __name__ == "__main__":
    sys.exit(main())
