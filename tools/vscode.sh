#!/usr/bin/env bash
# Checks, packages and tests the extension for VS Code (editors/vscode).
#
#   tools/vscode.sh            lints, types, unit tests, and the package dist/rtf.vsix
#   tools/vscode.sh browser    the package in VS Code's server, driven by Chromium
#
# RTF overrides the path of rtf in the browser, by default the result of `make build`.

. "$(dirname "$0")/env.sh"

goal=${1:-package}
# vsce needs Node 22, VS Code's server Node 24.
PATH=$(tools/venv.sh web):$PATH
export PATH

mkdir -p "$BUILD"
exec 9>"$BUILD/vscode.lock"
flock 9

modules=editors/vscode/node_modules
wanted=$({ node --version && sha256sum editors/vscode/package{,-lock}.json; } | sha256sum | cut -c1-16)
if [ "$(cat "$modules/complete" 2>/dev/null)" != "$wanted" ]; then
  say "installing npm packages into $modules"
  rm -rf "$modules"
  (cd editors/vscode && quietly npm ci --no-audit --no-fund) || die "npm could not install the extension's packages"
  printf '%s\n' "$wanted" >"$modules/complete"
fi

cd editors/vscode
case $goal in
  package)
    npm run --silent check
    npm run --silent test
    # The package must not contain anything that vsce warns about.
    log=$(mktemp)
    npm run --silent package 2>&1 | tee "$log"
    ! grep -q WARNING "$log" || die "vsce prints warnings"
    rm -f "$log"
    ;;
  browser)
    export RTF=${RTF:-$TARGET/release/rtf}
    [ -x "$RTF" ] || die "$RTF is missing" "make build"
    quietly npm run --silent package
    VSCODE_SERVER=$("$ROOT/tools/code-server.sh")
    export VSCODE_SERVER
    exec node --test tests/*.test.mjs
    ;;
  *) die "no goal \`$goal\`: package or browser" ;;
esac
