"""Plans of a task judged with SciPy and Pinocchio: the model that plan_optima.py and check_front.py
share. Nothing of it comes from the Rust code: the splines are SciPy's, the torques Pinocchio's, peaks
are the largest of many samples a piece.

    pip install numpy scipy pin
"""

import json
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.interpolate import BSpline
from scipy.optimize import minimize

ROOT = Path(__file__).resolve().parents[2]
ARM = ROOT / "sample-logs" / "arm"
TASKS = ROOT / "sample-logs" / "tasks"

DEGREE = 6
# Power is no polynomial: eight nodes a piece give plan C, which swings widely, 2e-4 too much.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
LIMITS = ["position", "speed", "acceleration", "jerk", "torque", "rod_speed", "rod_force", "pump_flow"]
# Samples a piece: while a plan is sought, and when it is judged.
COARSE, FINE = 64, 400
# What a plan may exceed a limit by, as a share, and still count as keeping it.
SLACK = 1e-6


def by_joint(names, values, missing=np.inf):
    return np.array([values.get(name, missing) for name in names])


class Cylinders:
    """Linkages and cylinders of all joints; arrays are by joint."""

    def __init__(self, names, path=ARM / "hydraulics.toml"):
        file = tomllib.loads(path.read_text())
        self.a, self.b, self.delta, self.sign, bore, rod, count = (
            np.array([file["joint"][name][key] for name in names])[:, None]
            for key in ("a_m", "b_m", "delta_rad", "angle_sign", "bore_m", "rod_m", "cylinders"))
        supply, back = file["supply_pressure_pa"], file["return_pressure_pa"]
        efficiency, self.pump = file["mechanical_efficiency"], file["pump_flow_m3_s"]
        self.cap, self.ring = count * np.pi / 4 * bore**2, count * np.pi / 4 * (bore**2 - rod**2)
        self.push = efficiency * (supply * self.cap - back * self.ring)
        self.pull = efficiency * (supply * self.ring - back * self.cap)

    def shares(self, q, qd, tau):
        """Of what the pump gives one joint, out and in; of the largest push and pull; of the pump by all."""
        theta = self.delta + self.sign * q
        length = np.sqrt(self.a**2 + self.b**2 - 2 * self.a * self.b * np.cos(theta))
        lever = self.sign * self.a * self.b * np.sin(theta) / length
        rod, force = lever * qd / self.pump, tau / lever
        out, back = self.cap * rod, -self.ring * rod
        return out, back, force / self.push, -force / self.pull, np.maximum(out, back).sum(axis=0)


class Model:
    """A task of `sample-logs/tasks` on the sample arm. Plans are intervals of movement, s."""

    def __init__(self, path, dwell_s=None):
        task = tomllib.loads(Path(path).read_text())
        foreign = {"start", "end", "hydraulics", "tool", "payload_kg"} & task.keys()
        foreign |= task.get("limits", {}).keys() - {"speed_deg_s", "acceleration_deg_s2", "jerk_deg_s3"}
        if foreign or task["arm"] != "sample" or task.get("degree", DEGREE) != DEGREE:
            raise ValueError(f"{path}: this model is of degree 6, the sample arm, rests at both ends; not of {foreign}")
        bare = pin.buildModelFromUrdf(str(ARM / "arm.urdf"))
        self.names = list(bare.names)[1:]
        self.joints = len(self.names)
        self.box = np.log(task["interval_s"])
        points = task["point"]
        q = np.deg2rad([[point["angles_deg"][name] for name in self.names] for point in points])
        self.n = len(points) - 1
        self.dwell_before_s = np.zeros(self.n)
        limits = task["limits"]
        low, high = bare.lowerPositionLimit, bare.upperPositionLimit
        self.middle, self.half = (low + high)[:, None] / 2, (high - low)[:, None] / 2
        self.speed = np.minimum(np.deg2rad(by_joint(self.names, limits["speed_deg_s"])), bare.velocityLimit)
        self.most = [x[:, None] for x in (
            self.speed, np.deg2rad(by_joint(self.names, limits["acceleration_deg_s2"])),
            np.deg2rad(by_joint(self.names, limits["jerk_deg_s3"])), bare.effortLimit)]
        self.cylinders = Cylinders(self.names)
        # Cut where the arm rests; from then on it carries what the points say.
        self.segments, first, mass = [], 0, 0.0
        for i, point in enumerate(points):
            dwell = point.get("dwell_s", 0.0)
            if i == self.n or (dwell and i):
                if i > first:
                    self.segments.append((slice(first, i), q[first:i + 1], self.pool(bare, task, mass)))
                first = i
            if dwell and i < self.n:
                self.dwell_before_s[i] = dwell if dwell_s is None else dwell_s
            elif dwell:
                raise ValueError(f"{path}: a dwell at the end")
            mass = point.get("payload_kg", mass)
        self.rest_s = self.dwell_before_s.sum()

    @staticmethod
    def pool(bare, task, mass):
        """The arm with a box of this mass before its tool."""
        model = bare.copy()
        if mass > 0:
            size = task["payload_size_m"]
            tool = model.frames[model.getFrameId("tool", pin.FrameType.BODY)]
            box = pin.Inertia.FromBox(mass, *size)
            at = tool.placement * pin.SE3(np.eye(3), np.array([size[0] / 2, 0, 0]))
            model.appendBodyToJoint(tool.parentJoint, box, at)
        return pin.ModelPool(model, 1)

    def times_s(self, interval_s):
        return np.concatenate([[0.0], np.cumsum(self.dwell_before_s + interval_s)])

    def intervals_s(self, times_s):
        return np.diff(times_s) - self.dwell_before_s

    def evaluate(self, interval_s, steps=COARSE):
        """Objectives f1, f2, f3 and shares of the limits by piece, [limit, joint, sign, piece]."""
        duration = interval_s.sum() + self.rest_s
        jerk2, power2, peaks = 0.0, 0.0, []
        for part, q, pool in self.segments:
            t = np.concatenate([[0.0], np.cumsum(interval_s[part])])
            knots, control = sextic(t, q)
            breaks = np.concatenate([t[:1], (t[:-1] + t[1:]) / 2, t[-1:]])
            width = np.diff(breaks)
            grid = np.append((breaks[:-1, None] + width[:, None] * np.arange(steps) / steps).ravel(), breaks[-1])
            nodes = breaks[:-1, None] + width[:, None] * (NODES + 1) / 2
            spline = BSpline.construct_fast(knots, control, DEGREE)
            at = np.concatenate([grid, nodes.ravel()])
            q, qd, qdd, qddd = (np.asfortranarray(spline(at, nu).T) for nu in range(4))
            tau = np.zeros_like(q, order="F")
            pin.rneaInParallel(1, pool, q, qd, qdd, tau)
            weights = (width[:, None] * WEIGHTS / 2).ravel()
            m = len(grid)
            jerk2 = jerk2 + qddd[:, m:] ** 2 @ weights
            power2 = power2 + (qd[:, m:] * tau[:, m:]) ** 2 @ weights
            peaks.append(self.peaks(grid, steps, *(x[:, :m] for x in (q, qd, qdd, qddd, tau))))
        f = np.array([duration, np.sqrt(jerk2 / duration).sum(), np.sqrt(power2 / duration).sum()])
        return f, np.concatenate(peaks, axis=1)

    def peaks(self, t, steps, q, qd, qdd, qddd, tau):
        """Largest share of each limit by row and piece; rows are limit, joint, sign and last the pump."""
        splines = [(q - self.middle) / self.half, *(x / most for x, most in zip((qd, qdd, qddd, tau), self.most))]
        out, back, push, pull, flow = self.cylinders.shares(q, qd, tau)
        signed = [pair for x in splines for pair in (x, -x)] + [out, back, push, pull]
        rows = np.concatenate([*signed, flow[None]])
        pieces = (len(t) - 1) // steps
        windows = rows[:, np.arange(pieces)[:, None] * steps + np.arange(steps + 1)]
        top = windows.argmax(axis=2) + np.arange(pieces) * steps
        i = np.clip(top, 1, len(t) - 2)
        line = np.arange(len(rows))[:, None]
        a, b, c = rows[line, i - 1], rows[line, i], rows[line, i + 1]
        left, right = (b - a) / (t[i] - t[i - 1]), (c - b) / (t[i + 1] - t[i])
        bend = (right - left) / (t[i + 1] - t[i - 1])
        slope = left + bend * (t[i] - t[i - 1])
        inside = (bend < 0) & (left >= 0) & (right <= 0) & (top == i)
        gain = np.where(inside, -slope**2 / (4 * np.where(inside, bend, -1.0)), 0.0)
        return rows[line, top] + gain

    def by_limit(self, peaks):
        """Share of each limit, [limit, joint]; the pump's is one row at the end, so a list."""
        most = peaks.max(axis=1)
        signed = most[:-1].reshape(len(LIMITS) - 1, 2, self.joints).max(axis=1)
        return [*signed, most[-1:]]

    def violation(self, peaks):
        return float(sum(np.maximum(row - 1, 0).sum() for row in self.by_limit(peaks)))

    def describe(self, interval_s):
        """A plan as the JSON files have it."""
        f, peaks = self.evaluate(np.asarray(interval_s), FINE)
        shares = {name: round(float(row.max()), 9) for name, row in zip(LIMITS, self.by_limit(peaks))}
        return {"times_s": self.times_s(interval_s).tolist(), "duration_s": float(f[0]),
                "rms_jerk_rad_s3": float(f[1]), "rms_power_w": float(f[2]), "peak_share": shares}


def sextic(t, q):
    """Knots at mid-intervals, at rest up to jerk at both ends; knots and control points."""
    knots = np.concatenate([[t[0]] * (DEGREE + 1), (t[:-1] + t[1:]) / 2, [t[-1]] * (DEGREE + 1)])
    n = len(t) - 1
    control = np.empty((n + 7, q.shape[1]))
    control[:4], control[n + 3:] = q[0], q[-1]
    if n > 1:
        basis = BSpline.design_matrix(t[1:-1], knots, DEGREE).toarray()
        fixed = basis[:, :4] @ control[:4] + basis[:, n + 3:] @ control[n + 3:]
        control[4:n + 3] = np.linalg.solve(basis[:, 4:n + 3], q[1:-1] - fixed)
    return knots, control


def descend(model, start_s, weights, ceilings=(np.inf,) * 3, steps=COARSE, iterations=100):
    """Intervals near `start_s` that lessen the weighted sum of the objectives' logarithms under all limits
    and ceilings, by SciPy's SLSQP in the logarithms of the intervals."""
    weights, capped = np.asarray(weights, float), np.isfinite(ceilings)
    ceilings = np.log(np.asarray(ceilings)[capped])
    memory = {}

    def values(x):
        f, peaks = model.evaluate(np.exp(x), steps)
        return np.log(f), -np.log(np.maximum(peaks.ravel(), 0.2))

    def linear(x):
        key = x.tobytes()
        if key not in memory:
            memory.clear()
            f, g = values(x)
            ahead = [values(x + step) for step in 1e-6 * np.eye(model.n)]
            slope = [np.array([a[k] - here for a in ahead]).T / 1e-6 for k, here in enumerate((f, g))]
            # Beyond the lower edge of the logarithm nothing binds and nothing changes.
            memory[key] = (weights @ f, weights @ slope[0], np.append(ceilings - f[capped], g),
                           np.vstack([-slope[0][capped], slope[1]]))
        return memory[key]

    start = np.clip(np.log(start_s), *model.box)
    found = minimize(lambda x: linear(x)[0], start, jac=lambda x: linear(x)[1], method="SLSQP",
                     bounds=[tuple(model.box)] * model.n, options={"maxiter": iterations, "ftol": 1e-10},
                     constraints={"type": "ineq", "fun": lambda x: linear(x)[2], "jac": lambda x: linear(x)[3]})
    return np.exp(np.clip(found.x, *model.box))


def feasible(model, interval_s, slack=SLACK):
    """Objectives and whether every limit holds."""
    f, peaks = model.evaluate(interval_s, FINE)
    return f, peaks.max() <= 1 + slack


def read(path):
    return json.loads(Path(path).read_text())
