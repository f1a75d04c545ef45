#!/usr/bin/env bash
# Builds the references of the SDKs into build/docs/api, if their sources changed.
#
# Ada has none: gnatdoc is in no Debian package.

. "$(dirname "$0")/env.sh"

api=$BUILD/docs/api
mapfile -d '' sources < <(find docs/Doxyfile tools/api_docs.sh tools/requirements-docs.txt sdk/c/include \
  sdk/cpp/include/rtf sdk/python/rtf sdk/ruby sdk/lua/rtf.lua -type f ! -name '*.pyc' -print0 | sort -z)
key=$(sha256sum "${sources[@]}" | sha256sum | cut -c1-16)
[ "$(cat "$api/complete" 2>/dev/null)" != "$key" ] || exit 0

say "building the references of the SDKs"
rm -rf "$api"
mkdir -p "$api/lua"

{ cat docs/Doxyfile && printf 'OUTPUT_DIRECTORY = %s\n' "$api"; } >"$api/Doxyfile"
quietly doxygen "$api/Doxyfile" || die "doxygen failed"

python=$(tools/venv.sh docs)
PYTHONPATH=sdk/python quietly "$python/pdoc" --output-directory "$api/python" \
  rtf rtf.session rtf.gymnasium '!rtf.host' '!rtf.frameworks' || die "pdoc failed"

messages=$(cd sdk/ruby && yard doc --quiet --no-save --no-cache --no-progress --readme README.md \
  --title 'rtf: Ruby' --exclude 'lib/rtf/host' --output-dir "$api/ruby" 'lib/**/*.rb' 2>&1) || die "yard failed" "$messages"
[ -z "$messages" ] || die "yard printed warnings" "$messages"

# rtf.lua has annotations for the Lua language server. LDoc knows only its functions, without
# overloads, and expects types in parentheses.
{
  printf -- '---Functions for plug-ins in Lua.\n---@module rtf\n\n'
  awk 'BEGIN { RS = ""; ORS = "\n\n" } /\nfunction rtf\./' sdk/lua/rtf.lua |
    sed -E -e '/^---@overload/d' -e 's/<([^ >]*), ([^>]*)>/<\1,\2>/' \
      -e 's/^---@param ([a-z_]+)(\??) (fun\([^)]*\)(: [^ ]+)?|[^ ]+)/---@param \1 (\3\2)/' \
      -e 's/^---@return ([^ ]+)$/---@return (\1)/' -e 's/^---@return ([^ (]+) (.*)/---@return \2 (\1)/'
} >"$api/lua/rtf.lua"
messages=$(ldoc --dir "$api/lua" --project rtf --title 'rtf: Lua' "$api/lua/rtf.lua" 2>&1) || die "ldoc failed" "$messages"
[[ $messages != *rtf.lua:* ]] || die "ldoc printed warnings" "$messages"
rm "$api/lua/rtf.lua" "$api/Doxyfile"

for language in cpp python ruby lua; do
  [ -s "$api/$language/index.html" ] || die "$api/$language/index.html was not written"
done
printf '%s\n' "$key" >"$api/complete"
