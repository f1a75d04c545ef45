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
  rm -f "$top/$1"
  folder=$(dirname "$1")
  while [ "$folder" != . ] && rmdir "$top/$folder" 2>/dev/null; do
    folder=$(dirname "$folder")
  done
}

while IFS= read -r file; do
  remove "$file"
done <"$manifest"
remove share/rtf/manifest.txt
say "removed rtf from $top"
