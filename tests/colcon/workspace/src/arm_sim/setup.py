"""Installs the simulated arm."""

from setuptools import setup

setup(
    name="arm_sim",
    version="0.1.0",
    packages=["arm_sim"],
    tests_require=["pytest"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/arm_sim"]),
        ("share/arm_sim", ["package.xml"]),
    ],
)
