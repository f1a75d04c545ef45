#!/usr/bin/env bash
# Builds the user's guide into build/docs/html, and checks it.
#
#   tools/docs.sh [RTF]     RTF: the program whose command line is documented;
#                           by default the result of `make build`

. "$(dirname "$0")/env.sh"

rtf=${1:-$TARGET/release/rtf}
[ -x "$rtf" ] || die "$rtf is missing" "run \`make build\` first"

tools/bootstrap.sh docs

mdbook=$(tools/cargo_tool.sh mdbook 0.5.4 --no-default-features --features search)

docs=$BUILD/docs
mkdir -p "$docs"
tools/api_docs.sh
python3 tools/stage_docs.py "$rtf" "$docs"

messages=$("$mdbook/mdbook" build "$docs" 2>&1) || die "mdBook failed" "$messages"
if grep -E 'WARN|ERROR' <<<"$messages" >&2; then
  die "mdBook printed warnings"
fi
cp -R "$docs/api" "$docs/html/"
python3 tools/check_guide.py "$rtf" "$docs/html"
say "the guide: $docs/html/index.html"
