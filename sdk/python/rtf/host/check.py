"""Checks whether files can be loaded, without running them."""

from __future__ import annotations

import ast
import json
import sys

from rtf.host.predecessor import CLASS_NAME

_KINDS = {
    "TestCase": "test",
    "EpisodeTest": "test",
    "VectorTest": "test",
    "FixtureManager": "fixture",
}


def check_files(files: list[str]) -> None:
    """Check each file and print one JSON object per line."""
    for file in files:
        sys.stdout.write(json.dumps(check_file(file)) + "\n")


def check_file(file: str) -> dict[str, object]:
    """Compile one file and return the result."""
    try:
        with open(file, "rb") as stream:
            tree = ast.parse(stream.read(), file)
        # The compiler finds more errors than the parser: `return` outside a function.
        compile(tree, file, "exec", dont_inherit=True)
    except SyntaxError as problem:
        found: dict[str, object] = {"file": file, "ok": False, "message": problem.msg}
        if problem.lineno:
            found["line"] = problem.lineno
        return found
    except (OSError, ValueError, RecursionError, MemoryError) as problem:
        text = getattr(problem, "strerror", None) or str(problem)
        return {"file": file, "ok": False, "message": text}
    kinds = _kinds(tree)
    return {"file": file, "ok": True, **({} if kinds is None else {"kinds": kinds})}


def _kinds(tree: ast.Module) -> list[str] | None:
    """Detect tests and fixtures by the names of base classes (the predecessor's by their own).

    `None` (unknown) for a file whose class derives from a class of another file. A file in
    which no class has a base class is no plug-in.
    """
    kind_of = dict(_KINDS)
    found = []
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            kinds = [kind_of[name] for name in map(_last_name, node.bases) if name in kind_of]
            if node.name == CLASS_NAME:
                kinds.append("test")
            if kinds:
                kind_of[node.name] = kinds[0]
                found.append(kinds[0])
    derived = any(isinstance(node, ast.ClassDef) and node.bases for node in ast.walk(tree))
    return sorted(set(found), reverse=True) if found or not derived else None


def _last_name(base: ast.expr) -> str:
    if isinstance(base, ast.Attribute):
        return base.attr
    return base.id if isinstance(base, ast.Name) else ""
