#!/bin/sh
# Starts the tests as the scripts of libtool do.
exec "$(dirname "$0")/arm_test" "$@"
