#!/usr/bin/env bash
# Removes what tools/install.sh has put below PREFIX, and the folders that are
# empty then. Files that it has not installed are left alone.

. "$(dirname "$0")/env.sh"

PREFIX=${PREFIX:-/usr/local}
top=${DESTDIR:-}$PREFIX
manifest=$top/share/rtf/manifest.txt
[ -e "$manifest" ] || die "$manifest is missing: rtf was not installed there by make install"

remove() {
  local folder
  folder=$(dirname "$1")
  rm -f "$top/$1"
  if [[ $1 == *.py ]]; then # what Python made of it
    rm -f "$top/$folder/__pycache__/$(basename "$1" .py)".*.pyc
    rmdir "$top/$folder/__pycache__" 2>/dev/null || true
  fi
  while [ "$folder" != . ] && rmdir "$top/$folder" 2>/dev/null; do
    folder=$(dirname "$folder")
  done
}

while IFS= read -r file; do
  remove "$file"
done <"$manifest"
remove share/rtf/manifest.txt
say "removed rtf from $top"
