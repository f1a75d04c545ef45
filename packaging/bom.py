#!/usr/bin/env python3
"""Joins the bills of materials of the programs and of the page into one (CycloneDX 1.5).

    bom.py SOURCES PAGE.json PROGRAM.json…    prints it

SOURCES is the directory of the sources, which is removed from all names, so that the same
sources always give the same text. The page contains only some of its npm packages; the others
are tools.
"""

from __future__ import annotations

import json
import os
import sys
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

Object = dict[str, Any]

# The npm packages that are embedded into the page, in addition to what they need.
EMBEDDED = ("rapidoc", "svelte", "uplot")


def main() -> None:
    """Joins them."""
    sources, page, *programs = sys.argv[1:]
    boms = [
        json.loads(Path(program).read_text().replace(f"file://{sources}", "file:///rtf"))
        for program in programs
    ]
    boms.append(without_tools(json.loads(Path(page).read_text())))
    print(json.dumps(join(boms), indent=1, sort_keys=True))


def without_tools(page: Object) -> Object:
    """The page's bill, with only what is embedded."""
    needs = {entry["ref"]: entry.get("dependsOn", []) for entry in page["dependencies"]}
    root = page["metadata"]["component"]["bom-ref"]
    needs[root] = [ref for ref in needs[root] if ref.rpartition("@")[0] in EMBEDDED]
    if len(needs[root]) != len(EMBEDDED):
        sys.exit(f"error: the page needs {needs[root]}, expected {', '.join(EMBEDDED)}")
    found: set[str] = set()
    queue = [root]
    while queue:
        ref = queue.pop()
        if ref not in found:
            found.add(ref)
            queue += needs[ref]
    page["components"] = [part for part in page["components"] if part["bom-ref"] in found]
    page["dependencies"] = [{"ref": ref, "dependsOn": needs[ref]} for ref in found]
    for part in page["components"]:
        part["scope"] = "required"  # npm's word for a build-time dependency is `optional`
    return page


def join(boms: list[Object]) -> Object:
    """One bill of all, sorted, with the time of the commit and without a random number."""
    parts: dict[str, Object] = {}
    needs: dict[str, set[str]] = {}
    for bom in boms:
        for part in [bom["metadata"]["component"], *bom["components"]]:
            parts.setdefault(part["bom-ref"], part)
        for entry in bom["dependencies"]:
            needs.setdefault(entry["ref"], set()).update(entry.get("dependsOn", []))
    roots = [bom["metadata"]["component"] for bom in boms]
    time = datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), timezone.utc)
    version = roots[0]["version"]
    needs["rtf"] = {root["bom-ref"] for root in roots}
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "timestamp": time.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": {
                "bom-ref": "rtf",
                "type": "application",
                "name": "rtf",
                "version": version,
                "licenses": [{"license": {"id": "Apache-2.0"}}],
            },
        },
        "components": [parts[ref] for ref in sorted(parts)],
        "dependencies": [{"ref": ref, "dependsOn": sorted(needs[ref])} for ref in sorted(needs)],
    }


if __name__ == "__main__":
    main()
