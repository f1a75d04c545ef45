# shellcheck shell=bash
# shellcheck disable=SC2154 # source, out: set by tests/frameworks/build.sh
# rostest, on a roscore of the suite; tools/middleware.sh installs the rest of ROS 1.
need_packages python3-rostest
setting ROS_PACKAGE_PATH "$source:/usr/share"
