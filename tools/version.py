#!/usr/bin/env python3
"""Compares the version of rtf in all files with that in Cargo.toml, or changes it.

    version.py          compares
    version.py 0.2.0    writes this version into all files

CHANGELOG.md must have a section of the version.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent

SOURCE = "Cargo.toml"
# Patterns of files, and lines with the version.
PLACES = {
    SOURCE: r'^version = "(.+)"$',
    "sdk/cpp/cmake/rtf/rtf-config-version.cmake": r'^else\(\)\n  set\(PACKAGE_VERSION "(.+)"\)$',
    "sdk/python/pyproject.toml": r'^version = "(.+)"$',
    "sdk/python/rtf/__init__.py": r'^__version__ = "(.+)"$',
    "sdk/ruby/lib/rtf/version.rb": r'^  VERSION = "(.+)"$',
    "web/package.json": r'^  "version": "(.+)",$',
    "web/package-lock.json": r'^  (?:    )?"name": "rtf.*",\n +"version": "(.+)",$',
    "editors/*/package.json": r'^  "version": "(.+)",$',
    "editors/*/package-lock.json": r'^  (?:    )?"name": "rtf.*",\n +"version": "(.+)",$',
    "editors/schemastore/catalog.*": r"releases/([^/]+)/",
    "packaging/ament/*/package.xml": r"^  <version>(.+)</version>$",
}


def main() -> None:
    """Compares, or writes."""
    if len(sys.argv) > 1:
        write(sys.argv[1])
    version = re.search(PLACES[SOURCE], (TOP / SOURCE).read_text(), re.M)[1]  # type: ignore[index]
    problems = [
        f"{path.relative_to(TOP)}: expected {version}, found {found or 'no version'}"
        for path, found in versions()
        if found != version
    ]
    if not re.search(rf"^## \[{re.escape(version)}\]", (TOP / "CHANGELOG.md").read_text(), re.M):
        problems.append(f"CHANGELOG.md: expected a section `## [{version}]`")
    if problems:
        hint = f"hint: tools/version.py {version}"
        sys.exit("\n".join(["error: the versions differ", *problems, hint]))
    print(version)


def versions() -> list[tuple[Path, str]]:
    """The versions in each file; an empty one if a file has none."""
    found = []
    for path, pattern in files():
        texts = re.findall(pattern, path.read_text(), re.M)
        found += [(path, text) for text in texts or [""]]
    return found


def files() -> list[tuple[Path, str]]:
    """The files with a version, and the pattern of its line."""
    return [
        (path, pattern)
        for glob, pattern in PLACES.items()
        for path in (TOP.glob(glob) if "*" in glob else [TOP / glob])
    ]


def write(version: str) -> None:
    """Writes a version into all files."""
    for path, pattern in files():
        path.write_text(
            re.sub(
                pattern,
                lambda line: line[0].replace(line[1], version),
                path.read_text(),
                flags=re.M,
            )
        )
    subprocess.run(["cargo", "update", "--workspace", "--offline", "--quiet"], cwd=TOP, check=True)


if __name__ == "__main__":
    main()
