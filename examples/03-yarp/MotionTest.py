"""Tests whether the head goes where it is sent."""

from __future__ import annotations

import argparse

import rtf
import yarp

JOINT = 0
TARGET_DEG = 4.0
TOLERANCE_DEG = 0.5


class MotionTest(rtf.TestCase):
    """Moves a joint through YARP's remote control board, and home again."""

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--remote", required=True)
        remote = parser.parse_args(args).remote
        yarp.Network.init()
        options = yarp.Property()
        options.put("device", "remote_controlboard")
        options.put("remote", remote)
        options.put("local", "/MotionTest")
        self.driver = yarp.PolyDriver(options)
        if not self.driver.isValid():
            self.error(f"no control board at {remote}")
        self.encoders = self.driver.viewIEncoders()
        self.position = self.driver.viewIPositionControl()
        modes = self.driver.viewIControlMode()
        modes.setControlMode(JOINT, yarp.VOCAB_CM_POSITION)

    def run(self) -> None:
        self.require(self.encoders.getAxes() == 6, "the head has six joints")
        self.position.setRefSpeed(JOINT, 10.0)
        self.position.positionMove(JOINT, TARGET_DEG)
        self.wait_until(
            lambda: abs(self.degrees() - TARGET_DEG) < TOLERANCE_DEG, 10, "the joint at its target"
        )
        self.measure("position error", abs(self.degrees() - TARGET_DEG), "deg", high=TOLERANCE_DEG)

    def degrees(self) -> float:
        """Where the joint is."""
        vector = yarp.Vector(self.encoders.getAxes())
        self.encoders.getEncoders(vector.data())
        return float(vector[JOINT])

    def tearDown(self) -> None:
        if hasattr(self, "position"):
            self.position.positionMove(JOINT, 0.0)
        if hasattr(self, "driver"):
            self.driver.close()
        yarp.Network.fini()
