# shellcheck shell=bash
# ROS 1 from Debian and Ubuntu: master, roslaunch, rosbag, rospy, roscpp. Its programs are
# in /usr/bin, so no set-up script is needed.

need_packages python3-roslaunch python3-rosbag python3-rospy python3-sensor-msgs python3-std-msgs \
  python3-std-srvs rosout libroscpp-dev libstd-msgs-dev g++ cmake python3-venv
