"""Runs a file of launch_testing for the host: `python3 -m rtf.frameworks.launch_testing_runner`.

It loads and launches the file as `launch_test` does, and reports the tests to the host, or lists
them.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import os
import sys
import traceback

from rtf import session as rtf_session
from rtf.frameworks import stack_dump
from rtf.frameworks.connection import Connection
from rtf.frameworks.listing import Listing
from rtf.frameworks.unittest_result import Stopped

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_DESCRIPTION = "generate_test_description"

_NO_PACKAGE = (
    "launch_testing cannot be imported: {}\n"
    "start rtf in a shell that has sourced the `setup.bash` of ROS 2 or of the workspace"
)


class Mistake(Exception):  # noqa: N818 - of the user
    """The file has no tests that can run."""


def main() -> int:
    """Run or list the tests; the exit code is 1 after a problem."""
    options = _parser().parse_args()
    stack_dump.prepare()
    listing = Listing.from_environment()
    connection = Connection.from_environment()
    try:
        launch = _import_launches()
        runs = launch.load(_load(options.file))
        if not any(True for run in runs for _ in run.all_cases()):
            raise Mistake("the file has no tests: methods `test…` of a `unittest.TestCase`")
        if listing is not None:
            return _list(listing, launch.starts(runs))
        if connection is not None:
            return _run(connection, launch, runs, options)
        return int(not launch.is_successful(runs, options.launch_arguments))
    except Exception as error:
        text, location = _problem(error, options.file)
        if listing is not None:
            listing.problem(text, location)
        elif connection is not None:
            _report(connection, error, text, location)
        else:
            raise
        return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="rtf.frameworks.launch_testing_runner")
    parser.add_argument("file", help="with a function `generate_test_description`")
    parser.add_argument("launch_arguments", nargs="*", metavar="NAME:=VALUE")
    parser.add_argument(
        "--stop-on-exit",
        action="store_true",
        help="stop when a launched process ends with an error before the tests have finished",
    )
    return parser


def _import_launches() -> Any:
    try:
        return importlib.import_module("rtf.frameworks.launch_testing_launch")
    except ImportError as error:
        raise Mistake(_NO_PACKAGE.format(error)) from None


def _load(file: str) -> Any:
    """Import a file as `launch_test` does."""
    name = os.path.splitext(os.path.basename(file))[0]
    spec = importlib.util.spec_from_file_location(name, os.path.abspath(file))
    if spec is None or spec.loader is None:
        raise Mistake("the file is not a Python file: its name does not end with `.py`")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not hasattr(module, _DESCRIPTION):
        raise Mistake(f"the file has no function `{_DESCRIPTION}`")
    return module


def _list(listing: Listing, starts: Any) -> int:
    for start in starts:
        listing.case(start)
    listing.finish()
    return 0


def _run(connection: Connection, launch: Any, runs: Any, options: argparse.Namespace) -> int:
    # A crash must not lose output.
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    reporter = launch.Reporter(connection, rtf_session.connect(connection), options.file)
    reporter.stops_on_exit = options.stop_on_exit
    selected = reporter.select(runs)
    try:
        is_successful = launch.is_successful(selected, options.launch_arguments, reporter)
    except Stopped:
        return 1
    if reporter.is_stopped():
        return 1
    reporter.finish()
    return int(not is_successful)


def _report(
    connection: Connection, error: Exception, text: str, location: dict[str, object] | None
) -> None:
    place = {} if location is None else {"location": location}
    connection.post("message", {"kind": "error", "text": text, **place})
    if not isinstance(error, Mistake):
        long = "".join(traceback.format_exception(type(error), error, error.__traceback__))
        connection.post("message", {"kind": "report", "text": long.rstrip()})


def _problem(error: Exception, file: str) -> tuple[str, dict[str, object] | None]:
    """Return what is wrong with a file, and the innermost line of it."""
    path = os.path.abspath(file)
    frames = traceback.walk_tb(error.__traceback__)
    lines = [number for frame, number in frames if frame.f_code.co_filename == path]
    if isinstance(error, SyntaxError) and error.filename == path and error.lineno:
        lines.append(error.lineno)
    location: dict[str, object] = {"file": path, "line": lines[-1]} if lines else {}
    # launch_testing's own complaints are of the type `Exception`.
    if type(error) in {Mistake, Exception}:
        return str(error), location or None
    short = "".join(traceback.format_exception_only(type(error), error)).strip()
    # The line of a syntax error is before its message.
    return short.rpartition("\n")[2], location or None


if __name__ == "__main__":
    sys.exit(main())
