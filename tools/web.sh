#!/usr/bin/env bash
# Builds the page into web/dist, which the next build of rtf embeds.
#
#   tools/web.sh            the page, when it is not there or something has changed
#   tools/web.sh modules    only what it is built, checked and tested with
#
# Packages come from npm, in the versions of web/package-lock.json; none of their
# scripts is run.

. "$(dirname "$0")/env.sh"

goal=${1:-page}
PATH=$(tools/node.sh):$PATH

# A key made of what files hold.
key_of() {
  { node --version && sha256sum "$@"; } | sha256sum | cut -c1-16
}

# Two makes at once must not build it twice.
mkdir -p "$BUILD"
exec 9>"$BUILD/web.lock"
flock 9

modules=web/node_modules
wanted=$(key_of web/package.json web/package-lock.json)
if [ "$(cat "$modules/complete" 2>/dev/null)" != "$wanted" ]; then
  say "getting what the page is built with, into $modules"
  rm -rf "$modules"
  (cd web && quietly npm ci --no-audit --no-fund) || die "npm could not install what the page needs" \
    "without a network: RTF_PAGE=none make build, and rtf tells how to add the page later"
  printf '%s\n' "$wanted" >"$modules/complete"
fi
[ "$goal" = page ] || exit 0

mapfile -d '' sources < <(find web/src web/public web/scripts web/index.html web/*.ts web/*.js \
  web/*.json schemas -type f ! -path 'web/src/generated/*' -print0 | sort -z)
wanted=$(key_of "${sources[@]}")
if [ "$(cat "$BUILD/web.built" 2>/dev/null)" != "$wanted" ] || [ ! -e web/dist/index.html ]; then
  say "building the page"
  (cd web && quietly npm run build)
  printf '%s\n' "$wanted" >"$BUILD/web.built"
fi
