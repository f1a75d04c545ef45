"""Takes a picture of the robot when a test failed, and attaches it to that test's result.

The picture is drawn from what the encoders say: it needs no camera in the simulator, and
would show a real iCub's posture as well.
"""

from __future__ import annotations

import math
import os
import struct
import tempfile
import zlib
from pathlib import Path
from typing import Any

# Drawn by the processor: neither a screen nor a graphics card is needed. MuJoCo reads it once.
os.environ.setdefault("MUJOCO_GL", "egl")

import icub_model
import mujoco
import rtf
import yarp
from icub_client import Part

WIDTH, HEIGHT = 640, 480


class Camera(rtf.FixtureManager):
    """Looks at the robot from ahead, only when something is to be seen."""

    def setup(self, args: list[str]) -> None:
        self.network = yarp.Network()
        robot = args[0] if args else "/icubSim"
        self.parts = {name: Part(self, f"{robot}/{name}") for name in icub_model.PARTS}
        self.drawn: Any = None

    def testFinished(self, test: rtf.Test, verdict: str, reason: str) -> None:
        if verdict != "failed":
            return
        posture: dict[str, float] = {}
        for part in self.parts.values():
            posture.update(zip(part.names, part.degrees(), strict=True))
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder, f"{test.name}.png")
            picture.write_bytes(self.draw(posture))
            self.report(f"the robot when {test.name} failed: {reason}")
            self.attach(picture)

    def tearDown(self) -> None:
        for part in getattr(self, "parts", {}).values():
            part.close()

    def draw(self, degrees: dict[str, float]) -> bytes:
        """Draws the robot in a posture, as a PNG file."""
        if self.drawn is None:
            model = icub_model.load(with_looks=True)
            self.drawn = (model, mujoco.MjData(model), mujoco.Renderer(model, HEIGHT, WIDTH))
        model, data, renderer = self.drawn
        for joint, angle in degrees.items():
            data.joint(joint).qpos[0] = math.radians(angle)
        mujoco.mj_forward(model, data)
        view = mujoco.MjvCamera()
        view.distance, view.azimuth, view.elevation = 1.9, -25, -12
        view.lookat[:] = [0, 0, 0]
        renderer.update_scene(data, view)
        return png(renderer.render())


def png(pixels: Any) -> bytes:
    """Return an image, height by width by three bytes, as a PNG file."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        checked = kind + content
        return struct.pack(">I", len(content)) + checked + struct.pack(">I", zlib.crc32(checked))

    height, width, _ = pixels.shape
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    content = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + content
