"""Tasks of the sample arm, one judge for every plan of them, whoever made it, and first guesses: NumPy, SciPy and
Pinocchio, no code of hydrotrace. `plan_time_peers.py` uses it.

A plan is a list of movements from rest to rest. A movement is a `scipy.interpolate.PPoly` of joint angles over time,
rad and s, and the times at which it is at its key points. Between movements the arm dwells.
"""
import tomllib
from dataclasses import dataclass
from math import factorial
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.interpolate import PPoly, make_interp_spline
from scipy.optimize import brentq

ROOT = Path(__file__).resolve().parents[1]
ARM = ROOT / "sample-logs/arm"
JOINTS = 6
SAMPLES = 4000  # of each interval between key points
HELD = 1e-6  # a limit is kept up to this share beyond it
JOINED = 1e-4  # a derivative is continuous, or zero at rest, up to this share of its largest value


@dataclass
class Leg:
    """From rest to rest: key points, what the tool carries, and the dwell at its end."""
    points: np.ndarray
    payload_kg: float
    dwell_s: float


class Task:
    """Key points and limits, in rad and s, joints base first."""

    def __init__(self, path):
        task = tomllib.loads(path.read_text())
        self.path, self.name = path, path.stem
        self.model = pin.buildModelFromUrdf(str(ARM / "arm.urdf"))
        self.names = list(self.model.names)[1:]
        of_joint = {key: np.deg2rad([limit[name] for name in self.names]) for key, limit in task["limits"].items()}
        self.speed = np.minimum(of_joint["speed_deg_s"], self.model.velocityLimit)
        self.acceleration, self.jerk = of_joint["acceleration_deg_s2"], of_joint["jerk_deg_s3"]
        self.low, self.high = self.model.lowerPositionLimit, self.model.upperPositionLimit
        self.size_m = task.get("payload_size_m", [0.0, 0.0, 0.0])
        points = np.deg2rad([[point["angles_deg"][name] for name in self.names] for point in task["point"]])
        self.legs, first, carried = [], 0, 0.0
        for i, point in enumerate(task["point"]):
            if i > 0 and ("dwell_s" in point or i == len(points) - 1):
                self.legs.append(Leg(points[first:i + 1], carried, point.get("dwell_s", 0.0)))
                first = i
            carried = point.get("payload_kg", carried)

    def loaded(self, payload_kg):
        """The arm with a box before the tool."""
        model = self.model.copy()
        if payload_kg > 0:
            tool = model.frames[model.getFrameId("tool")]
            box = pin.Inertia.FromBox(payload_kg, *self.size_m)
            box.lever = np.array([self.size_m[0] / 2, 0, 0])
            model.appendBodyToJoint(tool.parentJoint, box, tool.placement)
        return model


class Cylinders:
    """Lever, forces and flow of the arm's cylinders by the law of cosines."""

    def __init__(self, names):
        oil = tomllib.loads((ARM / "hydraulics.toml").read_text())
        a, b, self.delta, self.sign, bore, rod, number = (
            np.array([oil["joint"][name][key] for name in names])
            for key in ("a_m", "b_m", "delta_rad", "angle_sign", "bore_m", "rod_m", "cylinders"))
        self.a, self.b = a, b
        self.cap, self.ring = number * np.pi / 4 * bore**2, number * np.pi / 4 * (bore**2 - rod**2)
        supply, back, efficiency = oil["supply_pressure_pa"], oil["return_pressure_pa"], oil["mechanical_efficiency"]
        self.push = efficiency * (supply * self.cap - back * self.ring)
        self.pull = efficiency * (supply * self.ring - back * self.cap)
        self.pump = oil["pump_flow_m3_s"]

    def lever(self, q):
        theta = self.delta + self.sign * q
        length = np.sqrt(self.a**2 + self.b**2 - 2 * self.a * self.b * np.cos(theta))
        return self.sign * self.a * self.b * np.sin(theta) / length


class Movement:
    """Samples of one movement; its shares of every limit when it takes `slower` times as long."""

    def __init__(self, task, leg, curve, key_s):
        inside = np.concatenate([np.linspace(a, b, SAMPLES, endpoint=False) for a, b in zip(key_s, key_s[1:])])
        # Beside every join, on both sides of it: an extreme may lie there.
        joins = np.nextafter(curve.x[1:], -np.inf)
        t = np.unique(np.concatenate([inside, curve.x, joins]).clip(curve.x[0], np.nextafter(curve.x[-1], 0)))
        self.task, self.oil, self.curve, self.key_s = task, Cylinders(task.names), curve, key_s
        self.duration = key_s[-1] - key_s[0]
        q, self.qd, self.qdd, self.qddd = (curve(t, order) for order in range(4))
        model = task.loaded(leg.payload_kg)
        data, still = model.createData(), np.zeros(model.nv)
        self.gravity = np.array([pin.rnea(model, data, x, still, still) for x in q])
        self.inertia = np.array([pin.rnea(model, data, *x) for x in zip(q, self.qd, self.qdd)]) - self.gravity
        self.lever = self.oil.lever(q)
        self.ranges = np.abs(q - (task.high + task.low) / 2).max(axis=0) / ((task.high - task.low) / 2)
        self.key_error = np.abs(curve(key_s) - leg.points).max()
        self.squared_jerk = self._squared_jerk()
        self.smooth, self.at_rest = self._joins()
        if self.smooth < 2 or self.at_rest < 2:
            self.qddd = np.full((1, model.nv), np.inf)  # a step of the acceleration

    def _squared_jerk(self):
        """Its exact integral: two Gauss nodes more than the degree asks for."""
        nodes, weights = np.polynomial.legendre.leggauss(self.curve.c.shape[0] + 2)
        width = np.diff(self.curve.x)
        at = self.curve.x[:-1, None] + width[:, None] * (nodes + 1) / 2
        return np.einsum("i,k,ikj->j", width / 2, weights, self.curve(at, 3)**2)

    def _joins(self):
        """Derivatives up to these are continuous within the movement, and zero at its ends."""
        def steps(k):
            at = self.curve.derivative(k) if k else self.curve
            width = np.diff(at.x)[:-1, None]
            before = sum(at.c[-1 - i][:-1] * width**i for i in range(len(at.c)))
            scale = np.abs(self.curve(np.linspace(at.x[0], at.x[-1], 2000), k)).max(axis=0) + 1e-12
            ends = np.abs(np.stack([at.c[-1][0], at(at.x[-1])])) / scale if k else np.zeros(1)
            return (np.abs(at.c[-1][1:] - before) / scale).max(initial=0), ends.max()
        degree = self.curve.c.shape[0] - 1
        found = [steps(k) for k in range(degree)]
        return tuple(next((k for k, step in enumerate(part) if step > JOINED), degree) - 1
                     for part in zip(*found))

    def shares(self, slower=1.0):
        """Largest share of each limit, by name."""
        task, oil = self.task, self.oil
        torque = self.gravity + self.inertia / slower**2
        rod, force = self.lever * self.qd / slower, torque / self.lever
        flow = (np.where(rod > 0, oil.cap, oil.ring) * np.abs(rod)).sum(axis=1)
        by_joint = {
            "position": self.ranges,
            "speed": np.abs(self.qd).max(axis=0) / task.speed / slower,
            "acceleration": np.abs(self.qdd).max(axis=0) / task.acceleration / slower**2,
            "jerk": np.abs(self.qddd).max(axis=0) / task.jerk / slower**3,
            "torque": np.abs(torque).max(axis=0) / task.model.effortLimit,
            "rod force": (np.abs(force) / np.where(force > 0, oil.push, oil.pull)).max(axis=0),
        }
        found = {f"{name} {limit}": share for limit, shares in by_joint.items()
                 for name, share in zip(task.names, shares)}
        return found | {"pump flow": flow.max() / oil.pump}

    def stretch(self):
        """Smallest factor of time by which every limit holds; infinite if none does."""
        def over(slower):
            return max(self.shares(slower).values()) - 1
        if over(1.0) <= HELD:
            return 1.0
        return brentq(over, 1.0, 100.0, xtol=1e-9) if over(100.0) <= 0 else np.inf


@dataclass
class Verdict:
    """What the judge found."""
    least_s: float
    held_s: float
    worst: str
    worst_share: float
    shares: dict
    rms_jerk: float
    key_error_deg: float
    smooth: int
    at_rest: int


def judge(task, plan):
    """Duration as planned and once each movement is slowed down until it keeps every limit; root mean square jerk of
    the slowed plan, summed over joints, its mean over the whole time with dwells, as hydrotrace has it."""
    found = [Movement(task, leg, *movement) for leg, movement in zip(task.legs, plan, strict=True)]
    dwells = sum(leg.dwell_s for leg in task.legs)
    slower = [movement.stretch() for movement in found]
    held_s = sum(k * movement.duration for k, movement in zip(slower, found)) + dwells
    squared = sum(movement.squared_jerk / k**5 for k, movement in zip(slower, found))
    finite = np.isfinite(held_s)
    shares = {name: max(movement.shares()[name] for movement in found) for name in found[0].shares()}
    worst = max(shares, key=shares.get)
    return Verdict(
        least_s=sum(movement.duration for movement in found) + dwells, held_s=held_s, worst=worst,
        worst_share=shares[worst], shares=shares,
        rms_jerk=np.rad2deg(np.sqrt(squared / held_s).sum()) if finite else np.inf,
        key_error_deg=np.rad2deg(max(movement.key_error for movement in found)),
        smooth=min(movement.smooth for movement in found), at_rest=min(movement.at_rest for movement in found))


def from_spline(spline):
    breaks = np.unique(spline.t)
    return from_derivatives(breaks, [spline(breaks[:-1], order) for order in range(spline.k + 1)])


def from_derivatives(breaks, values):
    """The curve with these derivatives at the start of every piece, `[order][piece][joint]`."""
    scaled = [value / factorial(order) for order, value in enumerate(values)]
    return PPoly(np.array(scaled[::-1]), breaks)


def from_positions(breaks, position, degree):
    """The curve through what `position` gives at Chebyshev nodes of every piece: exact where it is of this degree."""
    nodes = (1 - np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))) / 2
    width = np.diff(breaks)
    values = np.stack([position(breaks[:-1] + width * node) for node in nodes])
    flat = np.linalg.solve(np.vander(nodes), values.reshape(degree + 1, -1)).reshape(values.shape)
    return PPoly(flat / width[None, :, None] ** np.arange(degree, -1, -1)[:, None, None], breaks)


def guess(task, leg):
    """Times at key points, each interval as its slowest joint needs it, and a quintic spline that keeps its limits."""
    travel = (np.abs(np.diff(leg.points, axis=0)) / task.speed).max(axis=1)
    t = np.concatenate(([0.0], np.cumsum(2 * travel + 0.5)))
    t *= slower(task, smooth(t, leg.points))
    return t, smooth(t, leg.points)


def smooth(t, positions):
    rest = [(order, np.zeros(JOINTS)) for order in (1, 2)]
    return make_interp_spline(t, positions, k=5, bc_type=(rest, rest))


def slower(task, curve):
    """Factor of time by which a spline keeps its limits of motion."""
    t = np.linspace(curve.t[0], curve.t[-1], 4000)
    limits = task.speed, task.acceleration, task.jerk
    return max((np.abs(curve(t, order)) / limit).max()**(1 / order) for order, limit in enumerate(limits, 1))


def split(t, pieces):
    """Every interval in equal pieces."""
    return np.append(np.concatenate([np.linspace(a, b, pieces, endpoint=False) for a, b in zip(t, t[1:])]), t[-1])
