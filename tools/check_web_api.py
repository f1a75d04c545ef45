#!/usr/bin/env python3
"""Holds the web API against its own description, with whatever schemathesis thinks of.

    check_web_api.py RTF

No answer may be a server's error (5xx) or other than described. Asked are a
server over a past run that has everything in it, once with paths that lead
somewhere and once with any, and a run that goes on, whose token is known.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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

SEED = 20261121
"""The same requests each time: what failed here fails again."""


def main() -> int:
    """Asks, and tells which of it was not as described."""
    rtf = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in [
            ("suite.xml", SUITE),
            ("full.lua", FULL),
            ("crash.lua", "function TestCase.run() os.exit(3) end\n"),
            ("patient.lua", PATIENT),
        ]:
            (folder / file).write_text(text)
        past = subprocess.run(
            [rtf, "run", "suite.xml"], check=False, cwd=folder, stdout=subprocess.PIPE
        )
        if past.returncode != 1:
            sys.exit(f"a run with two failing tests ended with {past.returncode}")
        with served([rtf, "serve", "--web=127.0.0.1:0"], folder) as (url, token):
            known = leading_somewhere(url)
            # What failed is really run again, now and then.
            ask(url, folder, known, [f"--header=Authorization: Bearer {token}"])
            ask(url, folder, {}, [])
        with served([rtf, "run", "--web=127.0.0.1:0", "patient.lua"], folder) as (url, token):
            # Control over the run itself would end the server; a past one is refused.
            known["path.run"] = runs(url)[1]
            ask(url, folder, known, [f"--header=Authorization: Bearer {token}"])
    return 0


@contextmanager
def served(command: list[str], folder: Path) -> Iterator[tuple[str, str]]:
    """The address of a server that runs meanwhile, and its token."""
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as server:
        assert server.stderr is not None
        try:
            line = server.stderr.readline()
            if "web: http" not in line:
                sys.exit(f"no address, but: {line}")
            url, _, token = line.removeprefix("web: ").strip().partition("#token=")
            yield url, token
            if server.poll() is not None:
                sys.exit(f"the server has ended with {server.returncode}")
        finally:
            server.terminate()


def get(url: str) -> dict[str, object]:
    """What a route answers."""
    with urllib.request.urlopen(url) as answer:
        found: dict[str, object] = json.load(answer)
        return found


def runs(url: str) -> list[str]:
    """The names of all runs, the newest first."""
    found = get(url + "api/v1/runs")["runs"]
    assert isinstance(found, list)
    return [run["run"] for run in found]


def leading_somewhere(url: str) -> dict[str, str | int]:
    """Parts of paths that name what there is."""
    route = "api/v1/runs/latest/tests/0/attempts/1/attachments"
    attached = get(url + route)["attachments"]
    assert isinstance(attached, list)
    numbers = {f"path.{name}": 0 for name in ("test", "suite", "fixture", "hook", "id")}
    return {
        "path.run": "latest",
        "path.number": 1,
        "path.path": attached[0]["attachment"]["path"],
        **numbers,
    }


def ask(url: str, folder: Path, known: dict[str, str | int], options: list[str]) -> None:
    """Lets schemathesis ask everything; ends the program when an answer is wrong."""
    config = folder / "schemathesis.toml"
    lines = [f"{json.dumps(name)} = {json.dumps(value)}" for name, value in known.items()]
    config.write_text("\n".join(["[parameters]", *lines, ""]))
    asked = subprocess.run(
        [
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
        ],
        check=False,
        cwd=folder,
    )
    if asked.returncode != 0:
        sys.exit("the API is not as described")


if __name__ == "__main__":
    sys.exit(main())
