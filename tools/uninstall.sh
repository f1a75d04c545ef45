#!/usr/bin/env bash
# Removes the files that tools/install.sh installed below PREFIX, and directories that are
# empty afterwards. Other files are kept.

. "$(dirname "$0")/env.sh"

PREFIX=${PREFIX:-/usr/local}
top=${DESTDIR:-}$PREFIX
manifest=$top/share/rtf/manifest.txt
[ -e "$manifest" ] || die "$manifest is missing: rtf was not installed there by make install"

remove() {
  local dir
  dir=$(dirname "$1")
  rm -f "$top/$1"
  if [[ $1 == *.py ]]; then # its byte code
    rm -f "$top/$dir/__pycache__/$(basename "$1" .py)".*.pyc
    rmdir "$top/$dir/__pycache__" 2>/dev/null || true
  fi
  while [ "$dir" != . ] && rmdir "$top/$dir" 2>/dev/null; do
    dir=$(dirname "$dir")
  done
}

while IFS= read -r file; do
  remove "$file"
done <"$manifest"
remove share/rtf/manifest.txt
say "removed rtf from $top"
