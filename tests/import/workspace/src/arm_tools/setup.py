"""A package of ament_python."""

from setuptools import setup

setup(
    name="arm_tools",
    version="0.1.0",
    packages=["arm_tools"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/arm_tools"]),
        ("share/arm_tools", ["package.xml"]),
    ],
)
