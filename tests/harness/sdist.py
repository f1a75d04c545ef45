"""Source distributions from PyPI, in the user's cache."""

from __future__ import annotations

import hashlib
import os
import subprocess
import tarfile
import tempfile
from pathlib import Path


def unpack(files: tarfile.TarFile, directory: str) -> None:
    """Unpacks an archive whose checksum is known. Early patch releases of Python 3.11, such as
    that of Debian 12, have no filters, but the checksum already excludes harmful members.
    """
    if hasattr(tarfile, "data_filter"):
        files.extractall(directory, filter="data")
    else:
        files.extractall(directory)


def fetch(python: str, name: str, version: str, sha256: str) -> Path:
    """Downloads and unpacks the package with the pip of `python`, unless it is in the cache."""
    cache = Path(os.environ.get("CACHE") or Path.home() / ".cache/rtf")
    source = cache / "public" / f"{name}-{version}"
    if source.exists():
        return source
    source.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=source.parent) as directory:
        pip = [python, "-m", "pip", "download", "--quiet", "--disable-pip-version-check"]
        package = ["--no-deps", "--no-binary", ":all:", f"{name}=={version}"]
        subprocess.run([*pip, "--dest", directory, *package], check=True)
        (archive,) = Path(directory).glob("*.tar.gz")
        if hashlib.sha256(archive.read_bytes()).hexdigest() != sha256:
            raise AssertionError(f"{archive.name} has another checksum")
        with tarfile.open(archive) as files:
            unpack(files, directory)
        # In one step: an interrupted download leaves nothing.
        (unpacked,) = (path for path in Path(directory).iterdir() if path.is_dir())
        unpacked.rename(source)
    return source
