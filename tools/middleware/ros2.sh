# shellcheck shell=bash
# ROS 2 from PyPI: rclpy, Fast DDS and some messages, for Python 3.10 to 3.13, without the
# `ros2` command. The check of lesson 6 needs iproute2.

need_packages iproute2
setting PATH "$(tools/venv.sh ros2):$PATH"
