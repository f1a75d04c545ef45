#!/bin/sh
# Prints a stream of this directory: `print.sh FILE [EXIT CODE]`.
cat "$(dirname "$0")/streams/$1"
exit "${2:-0}"
