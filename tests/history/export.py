#!/usr/bin/env python3
"""Reads Parquet files of `rtf history export` with Apache Arrow, and compares them with the CSV.

    export.py RTF

The interpreter has the packages of tools/requirements-export.txt.
"""

from __future__ import annotations

import csv
import io
import os
import pty
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

SUITE = """<suite name="arm &quot;left&quot;, &#233; &#26085;&#26412;">
  <test type="lua" name="a, &quot;b&quot; ' &#252; &#128512;">odd.lua</test>
  <test type="lua" name="No value">nothing.lua</test>
  <test type="lua" name="Good">good.lua</test>
</suite>
"""

REASON = 'quote " comma , newline \n tab \t NUL \0 é 日本'

ODD = """function TestCase.run()
  rtf.measure('lag "é", 日本\\n;', 12.1, "ms", 1 / 3, 20)
  rtf.fail('quote " comma , newline \\n tab \\t NUL \\0 é 日本')
end
"""

NOTHING = "function TestCase.run() rtf.measure('nothing', 0 / 0, 'm') end\n"

GOOD = """function TestCase.run()
  rtf.measure("lag", 0.1, "ms")
  rtf.measure("lag", 1e300, "ms")
end
"""

GIT = ["git", "-c", "user.name=t", "-c", "user.email=t@localhost"]

TYPES = {
    "timestamp[us, tz=UTC]": {"started", "author_time"},
    "double": {"duration", "value", "min", "max", "low", "high"},
    "bool": {"green", "dirty", "flaky"},
    "int64": {"attempts", "problems", "count", "not_finite", "outside", "cpus", "load_percent"}
    | {"passed", "failed", "error", "crashed", "timed-out", "collapsed", "interrupted", "skipped"},
}
"""The columns of each type; the others are strings."""


def main() -> int:
    """Makes two runs, one of them in a repository, and compares all tables."""
    rtf = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "suite.xml").write_text(SUITE)
        for test, text in [("odd", ODD), ("nothing", NOTHING), ("good", GOOD)]:
            (folder / f"{test}.lua").write_text(text)
        run(rtf, folder)
        for command in (["init", "-q", "-b", "main"], ["add", "."], ["commit", "-q", "-m", "é"]):
            subprocess.run([*GIT, *command], check=True, cwd=folder)
        run(rtf, folder)
        rows = {table: compare(rtf, folder, table) for table in ("runs", "results", "points")}
        check_content(rows)
        check_terminal(rtf, folder)
    print("5 passed, 0 failed")
    return 0


def run(rtf: str, folder: Path) -> None:
    """Runs the suite, one of whose tests fails."""
    done = subprocess.run([rtf, "run", "suite.xml"], check=False, cwd=folder)
    if done.returncode != 1:
        sys.exit(f"a run with a failing test ended with {done.returncode}")


def compare(rtf: str, folder: Path, table: str) -> list[dict[str, Any]]:
    """The rows of the Parquet file of a table, which are those of the CSV."""
    export = [rtf, "history", "export", "--table", table, "--format"]
    text = subprocess.run([*export, "csv"], check=True, cwd=folder, stdout=subprocess.PIPE)
    lines = list(csv.reader(io.StringIO(text.stdout.decode(), newline="")))
    file = folder / f"{table}.parquet"
    file.write_text("an earlier export")
    subprocess.run([*export, "parquet", "--output", str(file)], check=True, cwd=folder)
    if list(folder.glob(".*.tmp")):
        sys.exit("a temporary file is left")
    read = pq.read_table(file)
    metadata = pq.read_metadata(file).metadata
    if metadata.get(b"rtf.version") != b"1" or metadata.get(b"rtf.table") != table.encode():
        sys.exit(f"{table}: unexpected metadata {metadata}")
    if read.column_names != lines[0] or read.num_rows != len(lines) - 1 or read.num_rows == 0:
        sys.exit(f"{table}: {read.num_rows} rows of {read.column_names}, in CSV {lines}")
    check_types(table, zip(read.column_names, map(str, read.schema.types), strict=True))
    rows: list[dict[str, Any]] = read.to_pylist()
    for row, line in zip(rows, lines[1:], strict=True):
        for (column, value), cell in zip(row.items(), line, strict=True):
            if value != parsed(cell, value):
                sys.exit(f"{table}: {column} is {value!r}, in CSV {cell!r}")
    print(f"{table}: {len(rows)} equal rows, {len(lines[0])} columns")
    piped = subprocess.run([*export, "parquet"], check=True, cwd=folder, stdout=subprocess.PIPE)
    if piped.stdout != file.read_bytes():
        sys.exit(f"{table}: standard output differs from the file")
    return rows


def check_types(table: str, columns: Iterable[tuple[str, str]]) -> None:
    """Exits unless all columns have the documented types."""
    documented = {name: kind for kind, names in TYPES.items() for name in names}
    for name, kind in columns:
        if kind != documented.get(name, "string"):
            sys.exit(f"{table}: {name} is a column of {kind}")


def parsed(cell: str, value: object) -> object:
    """A cell of the CSV as a value of the same type."""
    match value:
        case None:
            return None if cell == "" else cell
        case bool():
            return {"true": True, "false": False}.get(cell)
        case datetime():
            return datetime.fromisoformat(cell)
        case int() | float():
            return type(value)(cell)
    return cell


def check_content(rows: dict[str, list[dict[str, Any]]]) -> None:
    """Exits unless the odd names and values of the suite are in the tables."""
    outside, inside = sorted(rows["runs"], key=lambda run: run["started"])
    if outside["commit"] is not None or inside["branch"] != "main" or inside["dirty"] is not False:
        sys.exit(f"unexpected revisions: {outside} {inside}")
    if inside["author_time"] is None:
        sys.exit("the author time is missing")
    found = {(row["suite"], row["test"], row["case"]): row for row in rows["results"]}
    odd = found[('arm "left", é 日本', 'a, "b" \' ü 😀', "")]
    if REASON not in odd["reason"]:
        sys.exit(f"unexpected reason: {odd['reason']!r}")
    points = {row["name"]: row for row in rows["points"]}
    nothing, lag = points["nothing"], points['lag "é", 日本\n;']
    if (nothing["value"], nothing["not_finite"], nothing["count"]) != (None, 1, 1):
        sys.exit(f"unexpected point without a value: {nothing}")
    if (lag["value"], lag["low"], lag["high"]) != (12.1, 1 / 3, 20):
        sys.exit(f"unexpected point: {lag}")


def check_terminal(rtf: str, folder: Path) -> None:
    """Exits unless a terminal gets an error and no binary data."""
    terminal, inner = pty.openpty()
    command = [rtf, "history", "export", "--format", "parquet"]
    refused = subprocess.run(
        command, check=False, cwd=folder, stdout=inner, stderr=subprocess.PIPE, text=True
    )
    os.close(inner)
    os.close(terminal)
    print(refused.stderr, end="")
    if refused.returncode != 2 or "--output PATH" not in refused.stderr:
        sys.exit(f"a terminal was not refused: {refused.returncode}")


if __name__ == "__main__":
    sys.exit(main())
