# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# launch and launch_testing are in no package registry: packages/ has small ones with their interface.
need_packages python3
setting PYTHONPATH "$source/packages"
