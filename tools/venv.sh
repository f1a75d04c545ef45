#!/usr/bin/env bash
# Prints the bin directory of a virtual environment, which it creates if necessary.
#
#   tools/venv.sh NAME      demo, test, …: one of tools/requirements-NAME.txt
#
# The environment is in the user's cache. Its name has a hash of the interpreter and of
# tools/requirements-NAME.txt, so an existing environment is never changed.

. "$(dirname "$0")/env.sh"

name=${1:?name: demo, test, …}
requirements=tools/requirements-$name.txt
[ -e "$requirements" ] || die "no such file: $requirements"

interpreter=$(python3 -c 'import sys; print(sys.executable, sys.version)')
key=$(printf '%s\n' "$interpreter" | cat - "$requirements" | sha256sum | cut -c1-12)
venv=$CACHE/venv-$name-$key

# Only one process at a time may create it.
mkdir -p "$CACHE"
exec 9>"$venv.lock"
flock 9

# After an interrupted run, this file is missing.
if [ ! -e "$venv/complete" ]; then
  say "installing $requirements into $venv"
  rm -rf "$venv"
  quietly python3 -m venv "$venv" || die "python3 cannot create a virtual environment"
  quietly "$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    --requirement "$requirements" || die "pip could not install $requirements"
  touch "$venv/complete"
fi
printf '%s\n' "$venv/bin"
