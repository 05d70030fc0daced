"""Writes arm-pinocchio.json, spatial-7.urdf and sliding-5.urdf: what Pinocchio makes of four arms.

pip install pin==4.1.0 numpy; python tests/reference/generate_arm.py
The tests read the files; this script runs only to make them anew.
"""

import json
from pathlib import Path

import numpy as np
import pinocchio as pin

HERE = Path(__file__).resolve().parent
SAMPLES = HERE.parent.parent / "sample-logs" / "arm"
STATES = 40


def vector(values):
    return " ".join(repr(float(value)) for value in values)


def inertial(rng):
    """A body of eight point masses, so that its inertia is a possible one."""
    mass, points = rng.uniform(0.2, 3.0, 8), rng.uniform(-0.2, 0.2, (8, 3))
    centre = mass @ points / mass.sum()
    r = points - centre
    inertia = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(mass, r))
    rpy = rng.uniform(-2, 2, 3)
    names = [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)]
    entries = " ".join(f'{name}="{float(inertia[i, j])!r}"' for name, i, j in names)
    return (f'<inertial><origin xyz="{vector(centre)}" rpy="{vector(rpy)}"/>'
            f'<mass value="{float(mass.sum())!r}"/><inertia {entries}/></inertial>')


def joint(rng, name, kind, parent, child, extra=""):
    origin = f'<origin xyz="{vector(rng.uniform(-0.4, 0.4, 3))}" rpy="{vector(rng.uniform(-3, 3, 3))}"/>'
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f"{origin}{extra}</joint>")


def sliding():
    """Five skew joints, of which the second and the fourth slide."""
    rng = np.random.default_rng(5)
    lines = ['<?xml version="1.0"?>', "<!-- Written by generate_arm.py. -->", '<robot name="sliding_5">',
             f'<link name="base">{inertial(rng)}</link>']
    parent = "base"
    for i in range(1, 6):
        axis = f'<axis xyz="{vector(rng.normal(size=3))}"/>'
        limit = '<limit lower="-2.5" upper="2.5" effort="100" velocity="2"/>'
        kind = "prismatic" if i in (2, 4) else "revolute"
        lines.append(joint(rng, f"q{i}", kind, parent, f"link{i}", axis + limit))
        lines.append(f'<link name="link{i}">{inertial(rng)}</link>')
        parent = f"link{i}"
    lines.append(joint(rng, "flange", "fixed", parent, "tool"))
    lines += ['<link name="tool"/>', "</robot>"]
    return "\n".join(lines) + "\n"


def spatial():
    """Seven skew joints, one without limits, a fixed joint between and a camera at the side."""
    rng = np.random.default_rng(7)
    lines = ['<?xml version="1.0"?>', "<!-- Written by generate_arm.py. -->", '<robot name="spatial_7">',
             f'<link name="base">{inertial(rng)}</link>']

    parent = "base"
    for i in range(1, 8):
        axis = f'<axis xyz="{vector(rng.normal(size=3))}"/>'
        limit = '<limit lower="-2.5" upper="2.5" effort="100" velocity="2"/>'
        if i == 4:
            lines.append(joint(rng, "bracket", "fixed", parent, "bracket"))
            lines.append(f'<link name="bracket">{inertial(rng)}</link>')
            parent = "bracket"
        kind, limit = ("continuous", "") if i == 3 else ("revolute", limit)
        lines.append(joint(rng, f"q{i}", kind, parent, f"link{i}", axis + limit))
        lines.append(f'<link name="link{i}">{inertial(rng)}</link>')
        parent = f"link{i}"
        if i == 5:
            lines.append(joint(rng, "mount", "fixed", parent, "camera"))
            lines.append(f'<link name="camera">{inertial(rng)}</link>')
    lines.append(joint(rng, "flange", "fixed", parent, "tool"))
    lines += ['<link name="tool"/>', "</robot>"]
    return "\n".join(lines) + "\n"


def rows(pose):
    return [float(x) for x in np.hstack([pose.rotation, pose.translation[:, None]]).ravel()]


def states(path, seed):
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    rng = np.random.default_rng(seed)
    joints = [model.joints[i] for i in range(1, model.njoints)]
    tool = model.getFrameId("tool", pin.FrameType.BODY)
    links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    found = []
    for _ in range(STATES):
        angle, speed, change = (rng.uniform(-x, x, model.nv) for x in (2.5, 3.0, 5.0))
        q = pin.neutral(model)
        for joint, value in zip(joints, angle):
            q[joint.idx_q:joint.idx_q + joint.nq] = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
        torque = pin.rnea(model, data, q, speed, change).copy()
        pin.forwardKinematics(model, data, q, speed)
        pin.updateFramePlacements(model, data)
        velocity = pin.getFrameVelocity(model, data, tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        energy = pin.computePotentialEnergy(model, data, q), pin.computeKineticEnergy(model, data, q, speed)
        found.append({
            "position_rad": angle.tolist(), "speed_rad_s": speed.tolist(), "acceleration_rad_s2": change.tolist(),
            "torque_nm": torque.tolist(), "tool_speed_m_s": float(np.linalg.norm(velocity.linear)),
            "energy_j": [float(x) for x in energy],
            "poses": {name: rows(data.oMf[model.getFrameId(name, pin.FrameType.BODY)]) for name in links},
        })
    return {"joints": [model.names[i] for i in range(1, model.njoints)], "states": found}


def main():
    (HERE / "spatial-7.urdf").write_text(spatial())
    (HERE / "sliding-5.urdf").write_text(sliding())
    arms = {
        "arm": states(SAMPLES / "arm.urdf", 1),
        "arm-with-plate": states(SAMPLES / "arm-with-plate.urdf", 2),
        "spatial-7": states(HERE / "spatial-7.urdf", 3),
        "sliding-5": states(HERE / "sliding-5.urdf", 4),
    }
    document = {"pinocchio": pin.__version__, "pose": "rotation and place, 3 by 4, row by row", "arms": arms}
    (HERE / "arm-pinocchio.json").write_text(json.dumps(document, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
