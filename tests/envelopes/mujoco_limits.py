"""Compares the limits that rtf reads from models with those of MuJoCo. Part of test_envelopes.py.

    mujoco_limits.py RTF icub|example|random

The models are the URDF of every iCub, the arm of example 01, or random MJCF with nested classes.
"""

from __future__ import annotations

import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import mujoco

EXAMPLE = Path(__file__).resolve().parents[2] / "examples/01-simulated-arm"
sys.path.insert(0, str(EXAMPLE))

import simulator  # noqa: E402

Limits = dict[str, tuple[float, float]]

RANDOM_MODELS = 300
NUMBER = r"(-?[0-9.]+)"
UNITS = {True: ("rad", "rad/s", "Nm"), False: ("m", "m/s", "N")}


def main() -> None:
    """Compares all models of a kind; exits at the first difference."""
    rtf, kind = Path(sys.argv[1]).resolve(), sys.argv[2]
    with tempfile.TemporaryDirectory() as directory:
        # MuJoCo writes a log there.
        os.chdir(directory)
        check = Check(rtf, Path(directory))
        if kind == "icub":
            models = sorted((Path(sys.prefix) / "share/iCub/robots").glob("*/model.urdf"))
            if len(models) < 10:
                sys.exit("there are not enough models of iCub")
            joints = [check.urdf(path.read_text(), path.parent.name) for path in models]
        elif kind == "example":
            joints = [check.mjcf(simulator.ARM, "example 01")]
        else:
            generator = random.Random(19)
            joints = [
                check.mjcf(random_model(generator), f"random model {number}")
                for number in range(RANDOM_MODELS)
            ]
    print(f"ok: {len(joints)} models, {sum(joints)} limits")


class Check:
    """Runs `rtf list` in a directory."""

    def __init__(self, rtf: Path, directory: Path) -> None:
        self.rtf = rtf
        self.directory = directory
        (directory / "Nothing.lua").write_text("function TestCase.run() end\n")

    def urdf(self, text: str, name: str) -> int:
        """Compares a URDF; the velocities with its text, which MuJoCo ignores."""
        tree = ElementTree.fromstring(text)
        wanted: dict[str, Limits] = {"position": {}, "velocity": {}, "torque": {}}
        hinges = {}
        for joint in tree.findall("joint"):
            limit, kind = joint.find("limit"), joint.get("type")
            if kind in ("revolute", "continuous", "prismatic"):
                hinges[joint.attrib["name"]] = kind != "prismatic"
            if limit is not None and kind in ("revolute", "prismatic"):
                most = float(limit.get("velocity", 0))
                if most > 0:
                    wanted["velocity"][joint.attrib["name"]] = (-math.inf, most)
        for element in tree.iter("mujoco"):
            element.clear()
        for link in tree.iter("link"):
            # Only joints are compared; some inertias are not physical.
            for part in list(link):
                link.remove(part)
            inertial = ElementTree.SubElement(link, "inertial")
            ElementTree.SubElement(inertial, "mass", value="1")
            moments = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}
            ElementTree.SubElement(inertial, "inertia", moments)
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(tree, encoding="unicode"))
        self.read_spec(spec.compile(), wanted)
        return self.compare(text, hinges, wanted, name)

    def mjcf(self, text: str, name: str) -> int:
        """Compares an MJCF."""
        model = mujoco.MjModel.from_xml_string(text)
        wanted: dict[str, Limits] = {"position": {}, "velocity": {}, "torque": {}}
        self.read_spec(model, wanted)
        hinge, slide = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
        kinds = {model.joint(index).name: int(model.jnt_type[index]) for index in range(model.njnt)}
        hinges = {name: kind == hinge for name, kind in kinds.items() if kind in (hinge, slide)}
        return self.compare(text, hinges, wanted, name)

    def read_spec(self, model: mujoco.MjModel, wanted: dict[str, Limits]) -> None:
        """The limits of a compiled model."""
        for index in range(model.njnt):
            name = model.joint(index).name
            if model.jnt_limited[index]:
                low, high = model.jnt_range[index]
                wanted["position"][name] = (low, high)
            if model.jnt_actfrclimited[index]:
                wanted["torque"][name] = (-math.inf, abs(model.jnt_actfrcrange[index]).max())

    def compare(
        self, text: str, hinges: dict[str, bool], wanted: dict[str, Limits], name: str
    ) -> int:
        """Compares the formulas of a model with limits; returns how many there are."""
        (self.directory / "model.xml").write_text(text)
        (self.directory / "model.limits.yaml").write_text(
            "model: model.xml\n"
            "signals: {position: '{joint}.q', velocity: '{joint}.dq', torque: '{joint}.tau'}\n"
        )
        signals = "".join(
            f"<signal name='{joint}.{suffix}' unit='{unit}'/>"
            for joint, is_hinge in hinges.items()
            for suffix, unit in zip(("q", "dq", "tau"), UNITS[is_hinge], strict=True)
        )
        suite = self.directory / "suite.xml"
        suite.write_text(
            f"<suite><signals><command>true</command>{signals}</signals>"
            "<envelope file='model.limits.yaml'/><test> Nothing.lua </test></suite>"
        )
        command = [str(self.rtf), "list", str(suite), "--monitors", "--format", "json"]
        run = subprocess.run(
            command, capture_output=True, text=True, cwd=self.directory, check=False
        )
        total = sum(len(limits) for limits in wanted.values())
        if total == 0:
            if "limits nothing" not in run.stderr:
                sys.exit(f"{name}: {run.stderr}")
            return 0
        if run.returncode != 0:
            sys.exit(f"{name}: {run.stderr}")
        found: dict[str, Limits] = {"position": {}, "velocity": {}, "torque": {}}
        for monitor in json.loads(run.stdout)["tests"][0]["monitors"]:
            joint, quantity = monitor["name"].rsplit(" ", 1)
            found[quantity][joint] = limits_of(monitor["formula"])
        for quantity, limits in wanted.items():
            if found[quantity].keys() != limits.keys():
                sys.exit(f"{name}: {quantity} of {found[quantity].keys() ^ limits.keys()}\n{text}")
            for joint, sides in limits.items():
                for one, other in zip(found[quantity][joint], sides, strict=True):
                    if one != other and abs(one - other) > 1e-9 * max(1, abs(other)):
                        sys.exit(f"{name}: {joint} {quantity}: {one}, expected {other}\n{text}")
        return total


def limits_of(formula: str) -> tuple[float, float]:
    """The sides of a formula."""
    low = re.search(f">= {NUMBER}", formula)
    high = re.search(f"<= {NUMBER}", formula)
    return (float(low[1]) if low else -math.inf, float(high[1]) if high else math.inf)


def random_model(generator: random.Random) -> str:
    """An MJCF with nested classes, bodies and all ways to set a limit."""
    # Without autolimits, MuJoCo refuses a range whose joint does not say whether it is limited.
    explicit = generator.random() < 0.2

    def attributes(is_default: bool) -> str:
        found = []
        if generator.random() < 0.5 and not explicit:
            low = generator.uniform(-3, 2)
            found.append(f'range="{low:.3f} {low + generator.uniform(0.1, 2):.3f}"')
        if explicit:
            found.append('range="-1 1.5" actuatorfrclimited="true" actuatorfrcrange="-2 1"')
            found.append(f'limited="{generator.choice(["true", "false"])}"')
        if generator.random() < 0.3 and not explicit:
            found.append(f'actuatorfrcrange="-{generator.uniform(0.1, 5):.2f} 3"')
        if generator.random() < 0.2 and not explicit:
            found.append('limited="false"')
        if generator.random() < 0.3:
            found.append(f'type="{generator.choice(["hinge", "slide"])}"')
        if not is_default and generator.random() < 0.5:
            found.append(f'class="{generator.choice(["main", "a", "b", "c"])}"')
        return " ".join(found)

    def body(depth: int) -> str:
        joints = ""
        for _ in range(generator.randint(1, 2)):
            counter[0] += 1
            joints += f'<joint name="j{counter[0]}" armature="1" {attributes(False)}/>'
        child = f'childclass="{generator.choice("abc")}"' if generator.random() < 0.4 else ""
        inner = body(depth - 1) if depth else ""
        return f'<body {child}>{joints}<geom size="0.1"/>{inner}</body>'

    counter = [0]
    angle = generator.choice(["", 'angle="radian"', 'angle="degree"'])
    autolimits = 'autolimits="false"' if explicit else generator.choice(["", 'autolimits="true"'])
    joint = [f"<joint {attributes(True)}/>" if generator.random() < 0.6 else "" for _ in range(4)]
    defaults = (
        f'<default>{joint[0]}<default class="a">{joint[1]}<default class="b">{joint[2]}</default>'
        f'</default><default class="c">{joint[3]}</default></default>'
    )
    bodies = "".join(body(2) for _ in range(2))
    return (
        f"<mujoco><compiler {angle} {autolimits}/>{defaults}"
        f"<worldbody>{bodies}</worldbody></mujoco>"
    )


if __name__ == "__main__":
    main()
