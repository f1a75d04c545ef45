"""Parquet files of `rtf history export`, read by Apache Arrow and compared with the CSV."""

from __future__ import annotations

import csv
import io
import json
import os
import pty
import subprocess
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from checkout import output_of, venv

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


TABLES = ["runs", "results", "points"]
Rows = list[dict[str, Any]]


@pytest.fixture(scope="module")
def directory(debug_rtf: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs, the second one in a repository."""
    directory = tmp_path_factory.mktemp("runs")
    (directory / "suite.xml").write_text(SUITE)
    for test, text in [("odd", ODD), ("nothing", NOTHING), ("good", GOOD)]:
        (directory / f"{test}.lua").write_text(text)
    run(debug_rtf, directory)
    for command in (["init", "-q", "-b", "main"], ["add", "."], ["commit", "-q", "-m", "é"]):
        subprocess.run([*GIT, *command], check=True, cwd=directory)
    run(debug_rtf, directory)
    return directory


def run(rtf: str, directory: Path) -> None:
    """Runs the suite, one of whose tests fails."""
    assert subprocess.run([rtf, "run", "suite.xml"], check=False, cwd=directory).returncode == 1


@pytest.mark.parametrize("table", TABLES)
def test_parquet_is_as_csv(debug_rtf: str, directory: Path, tmp_path: Path, table: str) -> None:
    text = export(debug_rtf, directory, table, "csv").decode()
    columns, *lines = csv.reader(io.StringIO(text, newline=""))
    file = tmp_path / f"{table}.parquet"
    file.write_text("an earlier export")
    piped = export(debug_rtf, directory, table, "parquet")
    export(debug_rtf, directory, table, "parquet", "--output", str(file))
    assert not list(tmp_path.glob(".*.tmp")), "a temporary file is left"
    assert piped == file.read_bytes()
    found = read(file)
    assert found["metadata"]["rtf.version"] == "1"
    assert found["metadata"]["rtf.table"] == table
    assert found["num_rows"] == len(lines) > 0
    documented = {name: kind for kind, names in TYPES.items() for name in names}
    assert found["columns"] == [[name, documented.get(name, "string")] for name in columns]
    for row, line in zip(found["rows"], lines, strict=True):
        for (column, value), cell in zip(row.items(), line, strict=True):
            is_time = value and documented.get(column, "").startswith("timestamp")
            read_value = datetime.fromisoformat(value) if is_time else value
            assert read_value == parsed(cell, read_value), column


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


def test_revisions(debug_rtf: str, directory: Path, tmp_path: Path) -> None:
    rows = exported(debug_rtf, directory, "runs", tmp_path)
    outside, inside = sorted(rows, key=lambda run: datetime.fromisoformat(run["started"]))
    assert outside["commit"] is None
    assert (inside["branch"], inside["dirty"]) == ("main", False)
    assert inside["author_time"] is not None


def test_odd_names_and_reasons(debug_rtf: str, directory: Path, tmp_path: Path) -> None:
    rows = exported(debug_rtf, directory, "results", tmp_path)
    found = {(row["suite"], row["test"], row["case"]): row for row in rows}
    assert REASON in found[('arm "left", é 日本', 'a, "b" \' ü 😀', "")]["reason"]


def test_odd_points(debug_rtf: str, directory: Path, tmp_path: Path) -> None:
    rows = exported(debug_rtf, directory, "points", tmp_path)
    points = {row["name"]: row for row in rows}
    nothing, lag = points["nothing"], points['lag "é", 日本\n;']
    assert (nothing["value"], nothing["not_finite"], nothing["count"]) == (None, 1, 1)
    assert (lag["value"], lag["low"], lag["high"]) == (12.1, 1 / 3, 20)


def test_terminal_gets_an_error_and_no_binary_data(debug_rtf: str, directory: Path) -> None:
    terminal, inner = pty.openpty()
    command = [debug_rtf, "history", "export", "--format", "parquet"]
    refused = subprocess.run(
        command, check=False, cwd=directory, stdout=inner, stderr=subprocess.PIPE, text=True
    )
    os.close(inner)
    os.close(terminal)
    assert refused.returncode == 2
    assert "--output PATH" in refused.stderr


def export(rtf: str, directory: Path, table: str, kind: str, *options: str) -> bytes:
    """The standard output of an export."""
    command = [rtf, "history", "export", "--table", table, "--format", kind, *options]
    return subprocess.run(command, check=True, cwd=directory, stdout=subprocess.PIPE).stdout


def exported(rtf: str, directory: Path, table: str, work: Path) -> Rows:
    """The rows of a table's Parquet file."""
    file = work / f"{table}.parquet"
    export(rtf, directory, table, "parquet", "--output", str(file))
    rows: Rows = read(file)["rows"]
    return rows


def read(file: Path) -> Any:
    """A Parquet file, as Apache Arrow reads it."""
    script = Path(__file__).with_name("read_parquet.py")
    return json.loads(output_of(venv("export") / "python", script, file))
