# shellcheck shell=bash
# ROS 2 as wheels: rclpy, Fast DDS and some messages, for Python 3.10 to 3.13. There
# is no `ros2` command in them. The check of lesson 6 counts packets in a network that it makes.

need_packages iproute2
setting PATH "$(tools/venv.sh ros2):$PATH"
