#!/usr/bin/env python3
"""A three-joint robot arm: MuJoCo steps it in real time, TCP clients talk to it.

    python3 simulator.py --port 17681

It answers each line that a client sends with one line, `ok …` or `error …`:

    joints              ok shoulder elbow wrist
    limits shoulder     ok -2.6 2.6         radians
    get shoulder        ok 0.399718         radians, from the joint's encoder
    set shoulder 0.4    ok                  the joint begins to move there
    time                ok 12.345           simulated seconds
    quit                ok                  and the connection ends

The encoders are MuJoCo's `jointpos` sensors. The motors are position servos
without an integral part, so the arm sags a little under its own weight, as
many a real one does. SIGTERM and SIGINT end the simulator with exit code 0.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time

from line_server import LineServer, Refused

try:
    import mujoco
except ImportError as problem:
    sys.exit(
        f"simulator: {sys.executable} cannot import mujoco: {problem}\n"
        "hint: `make demo` sets up a virtual environment with it, "
        "or: python3 -m pip install mujoco"
    )

STEP_SECS = 0.002
"""The physics' time step: 500 Hz, at which the stiff servos are stable."""

BURST_STEPS = 250
"""How many steps may be made up for at a time, so that clients are still served."""

HEARTBEAT_SECS = 5.0

ARM = f"""
<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="{STEP_SECS}" integrator="implicitfast"/>
  <default>
    <joint type="hinge" damping="0.2" armature="0.01" limited="true"/>
    <geom type="capsule" size="0.025" density="1000" contype="0" conaffinity="0"/>
    <position kp="60" dampratio="4" forcerange="-20 20"/>
  </default>
  <worldbody>
    <body name="upper_arm" pos="0 0 0.5">
      <joint name="shoulder" axis="0 0 1" range="-2.6 2.6"/>
      <geom fromto="0 0 0 0.30 0 0"/>
      <body name="forearm" pos="0.30 0 0">
        <joint name="elbow" axis="0 1 0" range="-2.0 2.0"/>
        <geom fromto="0 0 0 0.25 0 0" size="0.020"/>
        <body name="hand" pos="0.25 0 0">
          <joint name="wrist" axis="0 1 0" range="-1.5 1.5" damping="0.05" armature="0.002"/>
          <geom fromto="0 0 0 0.10 0 0" size="0.015"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder" joint="shoulder" ctrlrange="-2.6 2.6"/>
    <position name="elbow" joint="elbow" ctrlrange="-2.0 2.0"/>
    <position name="wrist" joint="wrist" ctrlrange="-1.5 1.5" kp="20"/>
  </actuator>
  <sensor>
    <jointpos name="shoulder" joint="shoulder"/>
    <jointpos name="elbow" joint="elbow"/>
    <jointpos name="wrist" joint="wrist"/>
  </sensor>
</mujoco>
"""


class Arm:
    """The physics, kept in step with the clock on the wall."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(ARM)
        self.data = mujoco.MjData(self.model)
        self.joints = [self.model.joint(index).name for index in range(self.model.njnt)]
        mujoco.mj_forward(self.model, self.data)
        self._started = time.monotonic()

    def catch_up(self) -> float:
        """Steps until simulated time is wall time; the seconds until the next step is due."""
        elapsed = time.monotonic() - self._started
        due = int((elapsed - self.data.time) / STEP_SECS)
        if due > 0:
            mujoco.mj_step(self.model, self.data, nstep=min(due, BURST_STEPS))
        next_step = self._started + float(self.data.time) + STEP_SECS
        return max(0.0, next_step - time.monotonic())

    def position(self, joint: str) -> float:
        """What the joint's encoder says, in radians."""
        return float(self.data.sensor(self._known(joint)).data[0])

    def limits(self, joint: str) -> tuple[float, float]:
        """The joint's range, in radians."""
        low, high = self.model.joint(self._known(joint)).range
        return float(low), float(high)

    def move(self, joint: str, target: float) -> None:
        """Lets the joint's servo move to `target` radians."""
        low, high = self.limits(joint)
        if not low <= target <= high:  # also false for NaN
            raise Refused(f"{joint} moves from {low} to {high}, not to {target}")
        self.data.actuator(joint).ctrl[0] = target

    def _known(self, joint: str) -> str:
        if joint not in self.joints:
            raise Refused(f"no joint `{joint}`, there are: {' '.join(self.joints)}")
        return joint


def answer(arm: Arm, words: list[str]) -> str:
    """Carries out one line of a client."""
    match words:
        case ["joints"]:
            return " ".join(arm.joints)
        case ["limits", joint]:
            return "{} {}".format(*arm.limits(joint))
        case ["get", joint]:
            return f"{arm.position(joint):.6f}"
        case ["set", joint, target]:
            arm.move(joint, number(target))
            return ""
        case ["time"]:
            return f"{arm.data.time:.3f}"
    raise Refused(
        "expected `joints`, `limits JOINT`, `get JOINT`, `set JOINT RADIANS`, `time` or `quit`"
    )


def number(text: str) -> float:
    """The number that a client wrote."""
    try:
        return float(text)
    except ValueError:
        raise Refused(f"`{text}` is not a number") from None


def main() -> int:
    """Serves the arm until a signal asks for the end."""
    arguments = argparse.ArgumentParser(description="A robot arm, simulated in real time.")
    arguments.add_argument(
        "--port",
        type=int,
        default=os.environ.get("ARM_PORT"),
        required="ARM_PORT" not in os.environ,
        help="TCP port on 127.0.0.1, 0 for a free one; otherwise the environment's ARM_PORT",
    )
    port = arguments.parse_args().port

    asked_to_stop: list[int] = []
    for stop in (signal.SIGTERM, signal.SIGINT):
        signal.signal(stop, lambda number, _frame: asked_to_stop.append(number))

    arm = Arm()
    try:
        server = LineServer(port, lambda words: answer(arm, words))
    except OSError as problem:
        print(f"simulator: cannot listen on 127.0.0.1:{port}: {problem}", file=sys.stderr)
        return 1
    print(f"arm with {', '.join(arm.joints)} on 127.0.0.1:{server.port}", flush=True)

    heartbeat = time.monotonic() + HEARTBEAT_SECS
    while not asked_to_stop:
        server.serve(arm.catch_up())
        if time.monotonic() >= heartbeat:
            heartbeat += HEARTBEAT_SECS
            print(f"alive: {arm.data.time:.1f} s, {server.clients} clients", flush=True)
    server.close()
    name = signal.Signals(asked_to_stop[0]).name
    print(f"stopped by {name} after {arm.data.time:.1f} simulated seconds", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
