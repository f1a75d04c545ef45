#!/usr/bin/env bash
# Checks that what rtf uses does not grow. Options: tools/soak.py --help.

. "$(dirname "$0")/env.sh"

python=$(tools/venv.sh soak)/python
exec "$python" tools/soak.py "$TARGET/release/rtf" "$@"
