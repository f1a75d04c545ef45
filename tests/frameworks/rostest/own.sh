#!/bin/sh
# Runs rostest on a master of its own, and copies the results of the node: `own.sh DIRECTORY`.
export ROS_HOME="$1/home" ROS_LOG_DIR="$1/log" ROS_IP=127.0.0.1
rostest "$(dirname "$0")/arm_tests/arm.test" >/dev/null 2>&1
cp "$ROS_HOME/test_results/arm_tests/rosunit-arm.xml" "$1/arm.xml"
rm -r "$ROS_HOME"
