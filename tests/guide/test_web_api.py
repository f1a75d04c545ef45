"""The web API is as its description says, for requests that schemathesis generates.

No response may be a server error (5xx) or deviate from the description. The tests use
a server with a past run that has every kind of data, once with existing and once with
arbitrary paths, and a server with a live run and its token.
"""

from __future__ import annotations

import json
import subprocess
import urllib.request
from pathlib import Path

import pytest
from checkout import call
from web_server import served

pytestmark = [pytest.mark.first, pytest.mark.venv("api")]
CHECKS = (
    "not_a_server_error,status_code_conformance,content_type_conformance,"
    "response_headers_conformance,response_schema_conformance,"
    "negative_data_rejection,positive_data_acceptance"
)

SUITE = """<suite name="arm">
  <fixture type="process" name="simulator"><command>sleep 1000</command></fixture>
  <hook on="failure" name="park"><command>echo parked</command></hook>
  <test type="lua" name="full" tags="a b">full.lua</test>
  <test type="lua" name="crash">crash.lua</test>
</suite>
"""

FULL = """function TestCase.run()
  rtf.report("<b>hello</b>")
  print("printed")
  rtf.measure("settling time", 9, "s", nil, 8)
  local file = io.open("note.txt", "w")
  file:write("note")
  file:close()
  rtf.attach("note.txt")
end
"""

PATIENT = "function TestCase.run() rtf.sleep(1000) end\n"

FILTER: dict[str, str | int] = {"query.filter": "suite(arm)"}
"""Not every text is a filter, which a description cannot express."""

SEED = 20261121
"""The same requests each time, so that failures are reproducible."""


@pytest.fixture
def directory(debug_rtf: str, tmp_path: Path) -> Path:
    """A directory with a past run."""
    for file, text in [
        ("suite.xml", SUITE),
        ("full.lua", FULL),
        ("crash.lua", "function TestCase.run() os.exit(3) end\n"),
        ("patient.lua", PATIENT),
    ]:
        (tmp_path / file).write_text(text)
    assert (
        subprocess.run([debug_rtf, "run", "suite.xml"], check=False, cwd=tmp_path).returncode == 1
    )
    return tmp_path


def test_existing_data_of_a_past_run(debug_rtf: str, directory: Path) -> None:
    with served([debug_rtf, "serve", "--web=127.0.0.1:0"], directory) as (url, token):
        # Failed tests are really rerun here.
        ask(url, directory, leading_somewhere(url), [f"--header=Authorization: Bearer {token}"])


def test_arbitrary_paths(debug_rtf: str, directory: Path) -> None:
    with served([debug_rtf, "serve", "--web=127.0.0.1:0"], directory) as (url, _):
        ask(url, directory, FILTER, [])


def test_live_run(debug_rtf: str, directory: Path) -> None:
    with served([debug_rtf, "serve", "--web=127.0.0.1:0"], directory) as (url, _):
        known = leading_somewhere(url)
    command = [debug_rtf, "run", "--web=127.0.0.1:0", "patient.lua"]
    with served(command, directory) as (url, token):
        # Stopping the live run would end the server; a past run is refused.
        known["path.run"] = runs(url)[1]
        ask(url, directory, known, [f"--header=Authorization: Bearer {token}"])


def get(url: str) -> dict[str, object]:
    """The response of a route."""
    with urllib.request.urlopen(url) as answer:
        found: dict[str, object] = json.load(answer)
        return found


def runs(url: str) -> list[str]:
    """The names of all runs, the newest first."""
    found = get(url + "api/v1/runs")["runs"]
    assert isinstance(found, list)
    return [run["run"] for run in found]


def leading_somewhere(url: str) -> dict[str, str | int]:
    """Path parameters that exist."""
    route = "api/v1/runs/latest/tests/0/attempts/1/attachments"
    attached = get(url + route)["attachments"]
    assert isinstance(attached, list)
    numbers = {f"path.{name}": 0 for name in ("test", "suite", "fixture", "hook", "id")}
    return {
        "path.run": "latest",
        "path.number": 1,
        "path.path": attached[0]["attachment"]["path"],
        **FILTER,
        **numbers,
    }


def ask(url: str, directory: Path, known: dict[str, str | int], options: list[str]) -> None:
    """Runs schemathesis over all routes."""
    config = directory / "schemathesis.toml"
    lines = [f"{json.dumps(name)} = {json.dumps(value)}" for name, value in known.items()]
    config.write_text("\n".join(["[parameters]", *lines, ""]))
    call(
        "schemathesis",
        f"--config-file={config}",
        "run",
        f"{url}api/v1/openapi.json",
        f"--checks={CHECKS}",
        "--phases=coverage,fuzzing",
        "--max-examples=20",
        f"--seed={SEED}",
        "--request-timeout=30",
        "--warnings=off",
        *options,
        cwd=directory,
    )
