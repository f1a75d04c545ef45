#!/usr/bin/env bash
# Prints the bin directory of a Node that can build the page: the machine's, or else one
# from a virtual environment in the user's cache, see tools/venv.sh.

. "$(dirname "$0")/env.sh"

# Same as `engines` in web/package.json.
is_enough='const [major, minor] = process.versions.node.split(".").map(Number);
  process.exit(major > 22 || (major === 22 && minor >= 12) || (major === 20 && minor >= 19) ? 0 : 1)'

if have npm && have node && node -e "$is_enough"; then
  dirname "$(command -v node)"
else
  tools/venv.sh web
fi
