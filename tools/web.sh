#!/usr/bin/env bash
# Builds the page into web/dist, which the next build of rtf embeds.
#
#   tools/web.sh            the page, if it is missing or a source changed
#   tools/web.sh modules    only installs its npm packages
#
# Packages come from npm, in the versions of web/package-lock.json, without running their
# install scripts.

. "$(dirname "$0")/env.sh"

goal=${1:-page}
PATH=$(tools/node.sh):$PATH

# A hash of the contents of files.
key_of() {
  { node --version && sha256sum "$@"; } | sha256sum | cut -c1-16
}

# Only one process at a time may build it.
mkdir -p "$BUILD"
exec 9>"$BUILD/web.lock"
flock 9

modules=web/node_modules
wanted=$(key_of web/package.json web/package-lock.json)
if [ "$(cat "$modules/complete" 2>/dev/null)" != "$wanted" ]; then
  say "installing the page's npm packages into $modules"
  rm -rf "$modules"
  (cd web && quietly npm ci --no-audit --no-fund) || die "npm could not install the page's packages" \
    "without a network: RTF_PAGE=none make build; rtf then explains how to add the page later"
  printf '%s\n' "$wanted" >"$modules/complete"
fi
[ "$goal" = page ] || exit 0

mapfile -d '' sources < <(find web/src web/public web/scripts web/*.html web/*.ts web/*.js \
  web/*.json schemas -type f ! -path 'web/src/generated/*' -print0 | sort -z)
wanted=$(key_of "${sources[@]}")
if [ "$(cat "$BUILD/web.built" 2>/dev/null)" != "$wanted" ] || [ ! -e web/dist/report.html ]; then
  say "building the page"
  (cd web && quietly npm run build)
  printf '%s\n' "$wanted" >"$BUILD/web.built"
fi
