"""Time of one evaluation of a plan of seven key points and six joints with SciPy and Pinocchio, as
`cargo bench --bench plan` does it: duration, root mean square jerk and power, and every limit, at eight
Gauss nodes a piece (56). On one core.

    pip install numpy scipy pin && OMP_NUM_THREADS=1 python benches/plan_peers.py

Written as someone at home in both libraries would: key points, limits and cylinders prepared once, the
spline solved and sampled for all joints at once, `pinocchio.rnea` called node by node with one `Data`.
`--parallel` also times `rneaInParallel` on one thread in place of the loop. Peaks are those of the nodes;
the Rust evaluation looks between them too.
"""
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.interpolate import BSpline

ROOT = Path(__file__).resolve().parents[1]
TASK = tomllib.loads((ROOT / "sample-logs/tasks/simulation.toml").read_text())
OIL = tomllib.loads((ROOT / "sample-logs/arm/hydraulics.toml").read_text())
PLANS = {"A": [2.01, 1.76, 2.02, 0.74, 2.32, 1.63], "B": [3.51, 3.83, 3.57, 2.4, 2.01, 3.62],
         "broken": [1.0, 1.6, 1.3, 0.7, 1.6, 1.2]}
REPEATS, CALLS = 30, 200

model = pin.buildModelFromUrdf(str(ROOT / "sample-logs/arm/arm.urdf"))
data, pool = model.createData(), pin.ModelPool(model, 1)
names = list(model.names)[1:]
points = np.deg2rad([[point["angles_deg"][name] for name in names] for point in TASK["point"]])
count = len(points)
nodes, weights = np.polynomial.legendre.leggauss(8)
nodes, weights = (nodes + 1) / 2, weights / 2
by_joint = {key: np.deg2rad([limit[name] for name in names]) for key, limit in TASK["limits"].items()}
speed = np.minimum(by_joint["speed_deg_s"], model.velocityLimit)
acceleration, jerk = by_joint["acceleration_deg_s2"], by_joint["jerk_deg_s3"]
middle = (model.upperPositionLimit + model.lowerPositionLimit) / 2
half = (model.upperPositionLimit - model.lowerPositionLimit) / 2
a, b, delta, sign, bore, rod, number = (
    np.array([OIL["joint"][name][key] for name in names])
    for key in ("a_m", "b_m", "delta_rad", "angle_sign", "bore_m", "rod_m", "cylinders"))
cap, ring = number * np.pi / 4 * bore**2, number * np.pi / 4 * (bore**2 - rod**2)
supply, back, efficiency = OIL["supply_pressure_pa"], OIL["return_pressure_pa"], OIL["mechanical_efficiency"]
push, pull = efficiency * (supply * cap - back * ring), efficiency * (supply * ring - back * cap)
pump = OIL["pump_flow_m3_s"]
control = np.empty((count + 6, len(names)))
control[:4], control[-4:] = points[0], points[-1]
tau = np.empty((count * 8, len(names)))
columns = np.empty((len(names), count * 8), order="F")


def torque(q, qd, qdd):
    for i in range(len(q)):
        tau[i] = pin.rnea(model, data, q[i], qd[i], qdd[i])
    return tau


def torque_in_parallel(q, qd, qdd):
    pin.rneaInParallel(1, pool, q.T, qd.T, qdd.T, columns)
    return columns.T


def evaluate(interval_s, torque):
    """Objectives and the sum of what limits are exceeded by."""
    t = np.concatenate(([0.0], np.cumsum(interval_s)))
    middles = (t[1:] + t[:-1]) / 2
    knots = np.concatenate(([t[0]] * 7, middles, [t[-1]] * 7))
    basis = BSpline.design_matrix(t[1:-1], knots, 6).toarray()
    fixed = basis[:, :4] @ control[:4] + basis[:, -4:] @ control[-4:]
    control[4:-4] = np.linalg.solve(basis[:, 4:-4], points[1:-1] - fixed)
    spline = BSpline.construct_fast(knots, control, 6)
    breaks = np.concatenate((t[:1], middles, t[-1:]))
    width = np.diff(breaks)
    at = (breaks[:-1, None] + width[:, None] * nodes).ravel()
    weight = (width[:, None] * weights).ravel()
    q, qd, qdd, qddd = spline(at), spline(at, 1), spline(at, 2), spline(at, 3)
    tau = torque(q, qd, qdd)
    duration = t[-1]
    f2 = np.sqrt(weight @ qddd**2 / duration).sum()
    f3 = np.sqrt(weight @ (qd * tau) ** 2 / duration).sum()
    theta = delta + sign * q
    lever = sign * a * b * np.sin(theta) / np.sqrt(a**2 + b**2 - 2 * a * b * np.cos(theta))
    velocity, force = lever * qd, tau / lever
    flow = np.where(velocity > 0, cap, ring) * np.abs(velocity)
    shares = np.concatenate([
        np.abs(np.stack([q - middle, qd, qdd, qddd, tau]) / allowed).max(axis=1).ravel(),
        flow.max(axis=0) / pump,
        (np.abs(force) / np.where(force > 0, push, pull)).max(axis=0),
        [flow.sum(axis=1).max() / pump],
    ])
    return duration, f2, f3, np.maximum(shares - 1, 0).sum()


allowed = np.stack([half, speed, acceleration, jerk, model.effortLimit])[:, None]
ways = {"rnea node by node": torque}
if "--parallel" in sys.argv:
    ways["rneaInParallel"] = torque_in_parallel
print(f"Pinocchio {pin.__version__}; CPU time of an evaluation, best and median of {REPEATS} x {CALLS}")
for way, by in ways.items():
    for name, plan in PLANS.items():
        interval_s, spent = np.array(plan), []
        for _ in range(REPEATS):
            start = time.process_time()
            for _ in range(CALLS):
                found = evaluate(interval_s, by)
            spent.append((time.process_time() - start) / CALLS * 1e6)
        print(f"  {way:18} {name:7} {min(spent):6.0f} us {np.median(spent):6.0f} us   "
              f"f = {found[0]:.2f} s, {found[1]:.6g} rad/s^3, {found[2]:.5g} W, exceeded by {found[3]:.3g}")
