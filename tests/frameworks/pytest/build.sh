# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# pytest with pytest-xdist, in a virtual environment.
venv=$(tools/venv.sh pytest)

# An interpreter that sees the packages of a virtual environment must be started in it.
printf '#!/bin/sh\nexec %q "$@"\n' "$venv/python" >"$out/python"
# One without any packages.
printf '#!/bin/sh\nexec %q -S "$@"\n' "$venv/python" >"$out/python-without-packages"
chmod +x "$out/python" "$out/python-without-packages"
setting RTF_PYTHON "$out/python"
