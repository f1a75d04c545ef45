# shellcheck shell=bash
# launch and launch_testing are in no package registry: packages/ has small ones with their interface.
need_packages python3
setting PYTHONPATH "$source/packages"
