"""The command ``python3 -m rtf.host``: serve the runner, or ``--check FILE…``."""

import os
import sys

# `-m` puts the working folder first, and there a `json.py` of the user's would
# take the place of the library's. The plug-in's own folder is put in when it
# is loaded, after the host has imported what it needs.
if sys.path[:1] == [os.getcwd()]:
    del sys.path[0]


def main(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code."""
    # Only one of the two is needed, and both take time to import.
    if arguments[:1] == ["--check"]:
        from rtf.host import check  # noqa: PLC0415

        check.check_files(arguments[1:])
        return 0
    if arguments:
        sys.stderr.write("usage: python3 -m rtf.host [--check FILE...]\n")
        return 2
    from rtf.host import serve  # noqa: PLC0415

    serve.prepare()
    if "RTF_FORK_SERVER" in os.environ:
        from rtf.host import fork  # noqa: PLC0415

        server = fork.Server()
        channel = server.serve()
        return 0 if channel is None else server.end(serve.serve(channel))
    return serve.serve()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
