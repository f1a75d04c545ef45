"""A small package with the interface of ROS 2's `launch`, which no package registry has.

It starts processes, reports what they print and how they end, and stops them with SIGINT.
"""

from __future__ import annotations

from .launch_context import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from .launch_service import LaunchService

__all__ = ["LaunchContext", "LaunchDescription", "LaunchDescriptionEntity", "LaunchService"]
