"""The page and the extension for VS Code: types, unit tests, and sessions in Chromium."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from checkout import ROOT, call, output_of

BROWSER = pytest.mark.xdist_group("browser")
"""One browser at a time: its time limits assume that no other renders."""


@pytest.mark.parametrize("script", ["check", "test"])
def test_page(script: str) -> None:
    call("tools/web.sh", "modules")
    path = f"{output_of('tools/node.sh')}:{os.environ['PATH']}"
    call("npm", "run", "--silent", script, cwd=ROOT / "web", PATH=path)


def test_page_is_built() -> None:
    call("tools/web.sh")


@BROWSER
@pytest.mark.parametrize(
    "file", sorted((ROOT / "web/tests").glob("*.test.mjs")), ids=lambda it: it.name.split(".")[0]
)
def test_page_in_a_browser(rtf: str, file: Path) -> None:
    call("tools/web-tests.sh", file, RTF=rtf)


def test_extension() -> None:
    call("tools/vscode.sh")


@BROWSER
def test_extension_in_a_browser(rtf: str) -> None:
    call("tools/vscode.sh", "browser", RTF=rtf)
