"""The iCub of the PyPI package icub-models, made ready for MuJoCo."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

try:
    import icub_models
    import mujoco
except ImportError as problem:
    sys.exit(
        f"{sys.executable} cannot import what the iCub needs: {problem}\n"
        "hint: `make icub` sets up a virtual environment with it, "
        "or: python3 -m pip install mujoco icub-models"
    )

STEP_SECS = 0.001
"""The physics' time step."""

PARTS = {
    "head": ["neck_pitch", "neck_roll", "neck_yaw"],
    "torso": ["torso_yaw", "torso_roll", "torso_pitch"],
    "left_arm": [
        "l_shoulder_pitch",
        "l_shoulder_roll",
        "l_shoulder_yaw",
        "l_elbow",
        "l_wrist_prosup",
        "l_wrist_pitch",
        "l_wrist_yaw",
    ],
    "right_arm": [
        "r_shoulder_pitch",
        "r_shoulder_roll",
        "r_shoulder_yaw",
        "r_elbow",
        "r_wrist_prosup",
        "r_wrist_pitch",
        "r_wrist_yaw",
    ],
}
"""The robot's parts and their joints, in the order of the ports' vectors."""

# MuJoCo's importer wants to know what URDF does not say: the file keeps its
# collision hulls only, and massless links get the least mass there is.
_COMPILER = (
    '<mujoco><compiler strippath="false" discardvisual="{discard}" balanceinertia="true" '
    'fusestatic="true" boundmass="1e-4" boundinertia="1e-7"/></mujoco>'
)


def load(*, with_looks: bool = False) -> Any:
    """Compiles the model; `with_looks` keeps the meshes that only a picture needs."""
    file = icub_models.get_model_file("iCubGazeboV2_7")
    share = Path(icub_models.get_models_path()).parent.parent
    text = file.read_text().replace("package://", f"{share}/")
    compiler = _COMPILER.format(discard="false" if with_looks else "true")
    spec = mujoco.MjSpec.from_string(re.sub(r"(<robot[^>]*>)", rf"\1{compiler}", text, count=1))
    spec.option.timestep = STEP_SECS
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # The hulls of neighbouring links overlap: with contacts the robot would burst.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    for joint in spec.joints:
        joint.damping = [4, 0, 0] if hasattr(joint.damping, "__len__") else 4.0
        joint.armature = 0.02
        servo = spec.add_actuator(
            name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT
        )
        servo.set_to_position(kp=300.0)
    spec.worldbody.add_light(pos=[-1.5, 0.5, 3], dir=[0.4, -0.1, -1])
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[3, 3, 0.1],
        pos=[0, 0, -0.62],
        rgba=[0.7, 0.75, 0.8, 1],
    )
    spec.visual.global_.offwidth = 640
    spec.visual.global_.offheight = 480
    return spec.compile()
