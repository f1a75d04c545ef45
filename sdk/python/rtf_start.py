"""Runs a module as ``python3 -m MODULE`` does: ``python3 -m rtf_start MODULE ARGUMENT…``.

``-m`` searches the working directory first, where a user may have a module with the name of
this SDK: ``rtf.py``, or a package ``rtf``. The SDK's is imported before.
"""

import os
import runpy
import sys

# `-m` adds it, unless an option or variable of the interpreter prevents that.
_directory = os.getcwd()
_is_searched = sys.path[:1] == [_directory]
if _is_searched:
    del sys.path[0]

import rtf  # noqa: E402 - only now it is the SDK's


def main() -> None:
    """Run the module of the first argument."""
    module = sys.argv.pop(1)
    # The host adds the directory of a plug-in after its own imports.
    if _is_searched and module != "rtf.host":
        sys.path.insert(0, _directory)
        if _is_hidden(_directory):
            # Workers of pytest-xdist search the same directories, and import the SDK later.
            sys.path.insert(0, os.path.dirname(os.path.dirname(rtf.__file__)))
    # The function with which the interpreter implements `-m`.
    runpy._run_module_as_main(module)  # type: ignore[attr-defined]


def _is_hidden(directory: str) -> bool:
    """Whether the SDK hides a module of the user."""
    package = os.path.join(directory, "rtf")
    return os.path.isfile(f"{package}.py") or os.path.isfile(os.path.join(package, "__init__.py"))


if __name__ == "__main__":
    main()
