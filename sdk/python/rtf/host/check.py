"""Says of files whether they could be loaded, without running them."""

from __future__ import annotations

import ast
import json
import sys

from rtf.host.predecessor import CLASS_NAME

_KINDS = {"TestCase": "test", "FixtureManager": "fixture"}


def check_files(files: list[str]) -> None:
    """Print what is known of each file, one JSON object a line."""
    for file in files:
        sys.stdout.write(json.dumps(check_file(file)) + "\n")


def check_file(file: str) -> dict[str, object]:
    """Compile one file and tell the outcome."""
    try:
        with open(file, "rb") as stream:
            tree = ast.parse(stream.read(), file)
        # The compiler finds what the parser lets through: `return` outside a function.
        compile(tree, file, "exec", dont_inherit=True)
    except SyntaxError as problem:
        found: dict[str, object] = {"file": file, "ok": False, "message": problem.msg}
        if problem.lineno:
            found["line"] = problem.lineno
        return found
    except OSError as problem:
        return {"file": file, "ok": False, "message": problem.strerror or str(problem)}
    except (ValueError, RecursionError, MemoryError) as problem:
        return {"file": file, "ok": False, "message": str(problem)}
    kinds = _kinds(tree)
    if kinds is None:
        return {"file": file, "ok": True}
    return {"file": file, "ok": True, "kinds": kinds}


def _kinds(tree: ast.Module) -> list[str] | None:
    """Tell tests and fixtures by the bases that classes name, and the predecessor's by their own.

    Nothing (`None`) is said of a file whose class derives from one of another
    file: that can be known only by running it. A file in which no class
    derives from anything is no plug-in.
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
