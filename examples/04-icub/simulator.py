#!/usr/bin/env python3
"""The iCub in MuJoCo behind YARP ports, in real time.

    python3 simulator.py [--robot icubSim] [--stuck JOINT]

Each part (head, torso, left_arm, right_arm) has the ports

    /icubSim/PART/state:o     its encoders in degrees, 100 times a second
    /icubSim/PART/command:i   where its joints shall go, in degrees
    /icubSim/PART/rpc:i       `get names`, `get limits` (low high low high …, in degrees)

They carry what the ports of the same names of a real iCub carry; its control boards
answer many more requests. Joints move at 60 degrees a second at most. `--stuck` (or the
variable ICUB_STUCK) holds a joint where it is, as a broken belt does.
"""

from __future__ import annotations

import argparse
import math
import os
import signal
import sys
import threading
import time
from typing import Any

import icub_model
import mujoco

try:
    import yarp
except ImportError as problem:
    sys.exit(
        f"{sys.executable} cannot import yarp: {problem}\nhint: `make icub` builds YARP's binding"
    )

PERIOD_SECS = 0.01
"""The encoders' period."""

SPEED = math.radians(60)
"""How fast a joint is led to its target, in radians a second."""

BEHIND_SECS = 0.5
"""Time that was lost beyond this is not made up for."""


class Robot:
    """The physics; each joint is led to its target."""

    def __init__(self, stuck: str) -> None:
        self.model = icub_model.load()
        self.data = mujoco.MjData(self.model)
        self.index = {self.model.joint(i).name: i for i in range(self.model.njnt)}
        if stuck and stuck not in self.index:
            sys.exit(f"simulator: the iCub has no joint `{stuck}`")
        self.stuck = stuck
        home = [min(max(0.0, low), high) for low, high in self.model.jnt_range]
        self.target = list(home)
        self.data.qpos[:] = home
        self.data.ctrl[:] = home

    def degrees(self, joints: list[str]) -> list[float]:
        """What the encoders say."""
        return [math.degrees(self.data.qpos[self.index[joint]]) for joint in joints]

    def limits(self, joint: str) -> tuple[float, float]:
        """The joint's range, in degrees."""
        low, high = self.model.jnt_range[self.index[joint]]
        return math.degrees(low), math.degrees(high)

    def command(self, joints: list[str], degrees: list[float]) -> None:
        """Leads joints to where they shall go, within their limits; NaN is not taken."""
        if len(degrees) != len(joints):
            print(f"simulator: {len(degrees)} angles for {len(joints)} joints", flush=True)
            return
        for joint, wanted in zip(joints, degrees, strict=True):
            low, high = self.limits(joint)
            if joint != self.stuck and math.isfinite(wanted):
                self.target[self.index[joint]] = math.radians(min(max(wanted, low), high))

    def step(self, seconds: float) -> None:
        """Goes on by `seconds`."""
        most = SPEED * seconds
        for index, target in enumerate(self.target):
            led = self.data.ctrl[index]
            self.data.ctrl[index] = led + min(max(target - led, -most), most)
        mujoco.mj_step(self.model, self.data, nstep=round(seconds / icub_model.STEP_SECS))


class Part:
    """The ports of one part."""

    def __init__(self, robot: Robot, prefix: str, joints: list[str]) -> None:
        self.robot = robot
        self.joints = joints
        self.state = yarp.BufferedPortVector()
        self.command = yarp.BufferedPortVector()
        self.rpc = yarp.RpcServer()
        ports = {"state:o": self.state, "command:i": self.command, "rpc:i": self.rpc}
        for name, port in ports.items():
            if not port.open(f"{prefix}/{name}"):
                sys.exit(f"simulator: the port {prefix}/{name} could not be opened")
        threading.Thread(target=self._answer, daemon=True).start()

    def obey(self) -> None:
        """Takes the newest command, if there is one."""
        wanted = self.command.read(False)
        if wanted is not None:
            self.robot.command(self.joints, [wanted[i] for i in range(wanted.size())])

    def tell(self) -> None:
        """Sends the encoders."""
        vector = self.state.prepare()
        vector.resize(len(self.joints))
        for i, value in enumerate(self.robot.degrees(self.joints)):
            vector[i] = value
        self.state.write()

    def _answer(self) -> None:
        asked = yarp.Bottle()
        while self.rpc.read(asked, True):
            answer = yarp.Bottle()
            self._fill(asked.toString(), answer)
            self.rpc.reply(answer)

    def _fill(self, asked: str, answer: Any) -> None:
        if asked == "get names":
            for joint in self.joints:
                answer.addString(joint)
        elif asked == "get limits":
            for joint in self.joints:
                for limit in self.robot.limits(joint):
                    answer.addFloat64(limit)
        else:
            answer.addString("unknown: get names | get limits")


def main() -> int:
    """Runs until a signal comes."""
    parser = argparse.ArgumentParser(description="the iCub in MuJoCo behind YARP ports")
    parser.add_argument("--robot", default="icubSim")
    parser.add_argument("--stuck", default=os.environ.get("ICUB_STUCK", ""), metavar="JOINT")
    options = parser.parse_args()
    stopping = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopping.set())

    robot = Robot(options.stuck)
    if not yarp.Network.checkNetwork(5.0):
        sys.exit("simulator: YARP's name server does not answer")
    network = yarp.Network()
    parts = [
        Part(robot, f"/{options.robot}/{name}", joints) for name, joints in icub_model.PARTS.items()
    ]
    print(f"simulator: the iCub is at /{options.robot}", flush=True)
    due = time.monotonic()
    while not stopping.is_set():
        for part in parts:
            part.obey()
        robot.step(PERIOD_SECS)
        for part in parts:
            part.tell()
        due = max(due + PERIOD_SECS, time.monotonic() - BEHIND_SECS)
        stopping.wait(max(0.0, due - time.monotonic()))
    for part in parts:
        for port in (part.state, part.command, part.rpc):
            port.interrupt()
            port.close()
    del network
    return 0


if __name__ == "__main__":
    sys.exit(main())
