#!/usr/bin/env python3
"""Runs the requests of docs/how-to/web.md: most against a live run, the rest against `rtf serve`.

    check_web_page.py RTF

Each request must succeed. A stream of live events is read for some seconds.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from check_web_api import served

PAGE = Path(__file__).resolve().parent.parent / "docs" / "how-to" / "web.md"
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.M | re.S)

QUICK = "function TestCase.run() rtf.report('done') end\n"
PATIENT = """function TestCase.run()
  print("waiting")
  io.flush()
  rtf.report("waiting")
  rtf.measure("settling time", 0.7, "s")
  rtf.sample("elbow", 0.5, "rad")
  rtf.sleep(1000)
end
"""
# The page stops test 3, skips the rest of suite 0, and then stops the run.
ARM = """<suite name="arm">
  <test type="lua" name="a">quick.lua</test>
  <test type="lua" name="b">quick.lua</test>
  <test type="lua" name="c">quick.lua</test>
  <test type="lua" name="d">patient.lua</test>
  <test type="lua" name="e">patient.lua</test>
</suite>
"""
FAILING = "function TestCase.run() rtf.fail('it is broken') end\n"
HAND = '<suite name="hand"><test type="lua">patient.lua</test></suite>\n'

# Fails for an error of the server. A stream does not end (exit code 28).
CURL = """curl() {
  local status=0
  command curl --fail --silent --show-error --max-time 5 "$@" || status=$?
  [ $status -eq 0 ] || [[ $status -eq 28 && $1 == -N ]]
}
"""
# The page asks for results of test 3.
WAIT = """for i in $(seq 600); do
  ! command curl --silent "$U/latest/tests/3/attempts/1/series" | grep -q elbow || exit 0
  sleep 0.1
done
echo "test 3 does not run" >&2
exit 1
"""


def main() -> None:
    """Runs all requests of the page."""
    rtf = str(Path(sys.argv[1]).resolve())
    lines = [
        line
        for block in BLOCK.findall(PAGE.read_text())
        for line in block.splitlines()
        if "curl" in line
    ]
    of_server = [line for line in lines if "/rerun" in line]
    of_run = [line for line in lines if line not in of_server]
    if len(of_run) < 10 or len(of_server) != 1:
        raise SystemExit(f"{PAGE.name} has other requests: was its format changed?")
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        for file, text in [
            ("quick.lua", QUICK),
            ("patient.lua", PATIENT),
            ("failing.lua", FAILING),
            ("arm.xml", ARM),
            ("hand.xml", HAND),
        ]:
            (directory / file).write_text(text)
        # The server stays when its run was stopped.
        live = [rtf, "run", "arm.xml", "hand.xml", "--web=127.0.0.1:0", "--web-linger=5s"]
        with served(live, directory) as (url, token):
            request(directory, url, token, [WAIT, *of_run])
        subprocess.run([rtf, "run", "failing.lua"], cwd=directory, check=False)
        with served([rtf, "serve", "--web=127.0.0.1:0"], directory) as (url, token):
            request(directory, url, token, of_server)


def request(directory: Path, url: str, token: str, lines: list[str]) -> None:
    """Runs the lines in a shell."""
    for line in lines:
        print(line, flush=True)
        variables = os.environ | {"U": f"{url}api/v1/runs", "TOKEN": token}
        subprocess.run(["bash", "-euc", CURL + line], cwd=directory, env=variables, check=True)
        print(flush=True)


if __name__ == "__main__":
    main()
