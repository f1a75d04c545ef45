# shellcheck shell=bash
# Programs without a framework; they need only a shell.
:
