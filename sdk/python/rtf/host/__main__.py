"""The command ``python3 -m rtf.host``: serve the runner, or ``--check FILE…``."""

import os
import sys

# `-m` puts the working directory first, where a user's `json.py` would replace the
# library's. The plug-in's directory is added when the plug-in is loaded, after the host's
# imports.
if sys.path[:1] == [os.getcwd()]:
    del sys.path[0]


def main(arguments: list[str]) -> int:
    """Run the command and return the exit code."""
    # Each import takes time.
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
