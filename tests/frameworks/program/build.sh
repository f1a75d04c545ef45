# shellcheck shell=bash
# Programs without a framework.
need_packages g++
program_with_descendants
