# shellcheck shell=bash
# Real producers of TAP: Perl's Test::More, bats, Node's test runner, tape (npm), tap.py (PyPI).
need_packages perl bats g++
program_with_descendants
path=$(tools/node.sh)
modules=$CACHE/tape-5.10.2
if [ ! -e "$modules/complete" ]; then
  rm -rf "$modules"
  mkdir -p "$modules"
  (cd "$modules" && PATH=$path:$PATH quietly npm install --silent --no-audit --no-fund tape@5.10.2)
  touch "$modules/complete"
fi
venv=$(tools/venv.sh tap)
setting NODE_PATH "$modules/node_modules"
setting PATH "$venv:$path:$PATH"
