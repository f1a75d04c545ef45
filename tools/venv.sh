#!/usr/bin/env bash
# Prints the bin folder of a virtual environment, which it makes when it is not there.
#
#   tools/venv.sh NAME      demo, test, …: one of tools/requirements-NAME.txt
#
# It lives in the user's cache under a key made of the interpreter and of the
# wanted packages, tools/requirements-NAME.txt: another Python or another
# version is another environment, and none is ever changed.

. "$(dirname "$0")/env.sh"

name=${1:?name: demo, test, …}
requirements=tools/requirements-$name.txt
[ -e "$requirements" ] || die "no such file: $requirements"

interpreter=$(python3 -c 'import sys; print(sys.executable, sys.version)')
key=$(printf '%s\n' "$interpreter" | cat - "$requirements" | sha256sum | cut -c1-12)
venv=$CACHE/venv-$name-$key

# Two makes at once must not build it twice.
mkdir -p "$CACHE"
exec 9>"$venv.lock"
flock 9

# Half an environment, left by an interrupted run, lacks this file.
if [ ! -e "$venv/complete" ]; then
  say "setting up what $requirements lists in $venv"
  rm -rf "$venv"
  quietly python3 -m venv "$venv" || die "python3 cannot make a virtual environment"
  quietly "$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    --requirement "$requirements" || die "pip could not install what $requirements lists"
  touch "$venv/complete"
fi
printf '%s\n' "$venv/bin"
