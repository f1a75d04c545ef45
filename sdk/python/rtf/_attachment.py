"""Copies attached files into the results."""

from __future__ import annotations

import os
import stat

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._session import Session

_CHUNK_BYTES = 1 << 20


def check(path: str) -> None:
    """Raise an error that says why a path cannot be attached: only files can."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        raise FileNotFoundError(f"there is no file `{path}` to attach") from None
    if stat.S_ISREG(mode):
        return
    types = {stat.S_IFDIR: "a directory", stat.S_IFIFO: "a FIFO"}
    file_type = types.get(stat.S_IFMT(mode), "a device or a socket")
    raise OSError(f"`{path}` cannot be attached: it is {file_type}, not a file")


def attach(session: Session, path: str, name: str, media_type: str, **more: object) -> str:
    """Attach a file, and return the path of the copy."""
    if session.task.attachments_dir:
        path = copy(path, name, session.task.attachments_dir)
    params: dict[str, object] = {"name": name, "path": path, "media_type": media_type, **more}
    session.notify_in_case("attached", params)
    return path


def copy(path: str, name: str, directory: str) -> str:
    """Copy a file into `directory` under a unique name, and return the copy's path.

    A `name` without an extension gets that of the file. A `/` in it separates directories, for
    files that belong together.
    """
    if not os.path.splitext(name)[1]:
        name += os.path.splitext(path)[1]
    safe = "".join(c if c.isalnum() or c in ".-_/" else "_" for c in name)
    first, *others = [part for part in safe.split("/") if part.strip(".")] or ["_"]
    number = 1
    while True:
        target = os.path.join(directory, f"{number}-{first}", *others)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        try:
            output = open(target, "xb")  # noqa: SIM115 - closed below, in any case
        except FileExistsError:
            number += 1
            continue
        with output, open(path, "rb") as source:
            while chunk := source.read(_CHUNK_BYTES):
                output.write(chunk)
        return target
