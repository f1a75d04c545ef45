# shellcheck shell=bash
# ROS 1 as Debian and Ubuntu have it: master, roslaunch, rosbag, rospy, roscpp.
# Nothing is sourced to use it: its programs are in /usr/bin.

need_packages python3-roslaunch python3-rosbag python3-rospy python3-std-msgs python3-std-srvs \
  rosout libroscpp-dev libstd-msgs-dev g++ cmake
