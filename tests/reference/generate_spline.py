#!/usr/bin/env python3
"""Writes spline-golden.json: sextic splines of the paper's plans, by SciPy.

The whole interpolation problem (key points and end conditions) is solved as one dense system,
so that nothing is shared with the banded solver and the closed end conditions under test.

    pip install numpy scipy
    python generate_spline.py            # writes spline-golden.json beside this file
    python generate_spline.py --check    # compares it with what is there, to 1e-10

Made with SciPy 1.17.1, NumPy 2.4.6.
"""

import json
import pathlib
import sys

import numpy as np
from scipy.interpolate import BSpline

DEGREE = 6
FILE = pathlib.Path(__file__).with_name("spline-golden.json")
SAMPLED_AT = [0.1, 0.3, 0.5, 0.77, 0.95]


def sextic(t, q):
    """Knots at mid-intervals, at rest up to jerk at both ends."""
    mids = (t[:-1] + t[1:]) / 2
    knots = np.concatenate([[t[0]] * (DEGREE + 1), mids, [t[-1]] * (DEGREE + 1)])
    controls = len(knots) - DEGREE - 1
    basis = BSpline(knots, np.eye(controls), DEGREE)
    rows, right = [basis(t)], [q]
    for order in (1, 2, 3):
        ends = basis.derivative(order)(t[[0, -1]])
        # Scaled to the size of the other rows; the right hand side is zero.
        rows.append(ends / np.abs(ends).max(axis=1, keepdims=True))
        right.append(np.zeros((2, q.shape[1])))
    return BSpline(knots, np.linalg.solve(np.vstack(rows), np.vstack(right)), DEGREE)


def squared_jerk(spline):
    """Integral of jerk squared of each joint: 4 Gauss nodes a piece are exact for degree 6."""
    jerk, breaks = spline.derivative(3), np.unique(spline.t)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    total = 0
    for a, b in zip(breaks[:-1], breaks[1:]):
        total = total + (b - a) / 2 * weights @ jerk((a + b) / 2 + (b - a) / 2 * nodes) ** 2
    return total


def segment(t, q):
    t, q = np.array(t), np.array(q)
    spline = sextic(t, q)
    at = t[-1] * np.array(SAMPLED_AT)
    states = [spline(at)] + [spline.derivative(order)(at) for order in (1, 2, 3)]
    values = {
        "t": t.tolist(),
        "q": q.tolist(),
        "knots": spline.t.tolist(),
        "control": spline.c.tolist(),
        "rms_jerk_per_joint_deg": np.sqrt(squared_jerk(spline) / t[-1]).tolist(),
        "sample_t": at.tolist(),
    }
    values.update({name: state.tolist() for name, state in zip(("pos", "vel", "acc", "jerk"), states)})
    return values, squared_jerk(spline)


def plan(segments, dwell):
    made = [segment(t, q) for t, q in segments]
    duration = sum(t[-1] for t, _ in segments) + dwell
    f2 = float(np.sqrt(sum(integral for _, integral in made) / duration).sum())
    return {
        "segments": [values for values, _ in made],
        "dwell": dwell,
        "f1": duration,
        "f2_deg_s3": f2,
        "f2_rad_s3": float(np.deg2rad(f2)),
    }


def worst(a, b):
    """Largest difference of two JSON values of the same form."""
    if isinstance(a, dict):
        assert a.keys() == b.keys(), (a.keys(), b.keys())
        return max(worst(a[key], b[key]) for key in a)
    if isinstance(a, list):
        assert len(a) == len(b)
        return max((worst(x, y) for x, y in zip(a, b)), default=0.0)
    return abs(a - b)


# Degrees and seconds, as the paper prints them: table 2 and the two tasks.
PLANS = json.loads('''
{
  "sim_A": {"dwell": 0.0, "segments": [
    {"t": [0.0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48],
     "q": [[43.35, 78.54, -90.05, 0.0, 0.0, 0.0],
           [46.35, 86.43, -56.68, 1.68, 1.31, 0.68],
           [55.04, 99.62, -39.25, 4.71, 3.65, 2.71],
           [62.67, 104.06, -21.94, 6.51, 5.53, 4.64],
           [68.04, 112.4, -9.04, 8.14, 6.99, 6.53],
           [74.4, 124.5, 1.68, 12.8, 8.18, 7.31],
           [84.13, 133.6, 12.81, 16.14, 10.15, 9.21]]}]},
  "sim_B": {"dwell": 0.0, "segments": [
    {"t": [0.0, 3.51, 7.34, 10.91, 13.31, 15.32, 18.94],
     "q": [[43.35, 78.54, -90.05, 0.0, 0.0, 0.0],
           [46.35, 86.43, -56.68, 1.68, 1.31, 0.68],
           [55.04, 99.62, -39.25, 4.71, 3.65, 2.71],
           [62.67, 104.06, -21.94, 6.51, 5.53, 4.64],
           [68.04, 112.4, -9.04, 8.14, 6.99, 6.53],
           [74.4, 124.5, 1.68, 12.8, 8.18, 7.31],
           [84.13, 133.6, 12.81, 16.14, 10.15, 9.21]]}]},
  "sim_C": {"dwell": 0.0, "segments": [
    {"t": [0.0, 1.51, 5.09, 10.23, 15.67, 18.98, 23.27],
     "q": [[43.35, 78.54, -90.05, 0.0, 0.0, 0.0],
           [46.35, 86.43, -56.68, 1.68, 1.31, 0.68],
           [55.04, 99.62, -39.25, 4.71, 3.65, 2.71],
           [62.67, 104.06, -21.94, 6.51, 5.53, 4.64],
           [68.04, 112.4, -9.04, 8.14, 6.99, 6.53],
           [74.4, 124.5, 1.68, 12.8, 8.18, 7.31],
           [84.13, 133.6, 12.81, 16.14, 10.15, 9.21]]}]},
  "task1_R1": {"dwell": 2.0, "segments": [
    {"t": [0.0, 7.744, 15.307, 22.863],
     "q": [[30.0, 130.0, -60.0, 0.0, 0.0, 0.0],
           [37.2, 126.4, -16.8, 6.8, 8.8, 10.4],
           [73.2, 119.2, 19.2, 14.7, 15.8, 16.0],
           [80.0, 104.0, 19.0, 16.0, 18.0, 18.0]]},
    {"t": [0.0, 8.113, 15.857],
     "q": [[80.0, 104.0, 19.0, 16.0, 18.0, 18.0],
           [61.2, 108.4, -1.6, 12.8, 11.8, 10.8],
           [57.2, 103.6, -12.8, 10.0, 10.0, 10.0]]}]},
  "task1_R2": {"dwell": 2.0, "segments": [
    {"t": [0.0, 7.744, 15.307, 22.863],
     "q": [[30.0, 130.0, -60.0, 0.0, 0.0, 0.0],
           [37.2, 126.4, -16.8, 6.8, 8.8, 10.4],
           [73.2, 119.2, 19.2, 14.7, 15.8, 16.0],
           [80.0, 104.0, 19.0, 16.0, 18.0, 18.0]]},
    {"t": [0.0, 6.113, 13.857],
     "q": [[80.0, 104.0, 19.0, 16.0, 18.0, 18.0],
           [61.2, 108.4, -1.6, 12.8, 11.8, 10.8],
           [57.2, 103.6, -12.8, 10.0, 10.0, 10.0]]}]},
  "task1_R3": {"dwell": 2.0, "segments": [
    {"t": [0.0, 7.744, 15.307, 20.863],
     "q": [[30.0, 130.0, -60.0, 0.0, 0.0, 0.0],
           [37.2, 126.4, -16.8, 6.8, 8.8, 10.4],
           [73.2, 119.2, 19.2, 14.7, 15.8, 16.0],
           [80.0, 104.0, 19.0, 16.0, 18.0, 18.0]]},
    {"t": [0.0, 8.113, 15.857],
     "q": [[80.0, 104.0, 19.0, 16.0, 18.0, 18.0],
           [61.2, 108.4, -1.6, 12.8, 11.8, 10.8],
           [57.2, 103.6, -12.8, 10.0, 10.0, 10.0]]}]},
  "task2_printed": {"dwell": 2.122, "segments": [
    {"t": [0.0, 9.431, 19.334],
     "q": [[30.0, 130.0, -60.0, 0.0, 0.0, 0.0],
           [44.4, 122.8, -20.4, 15.0, 14.4, 10.8],
           [80.0, 104.0, 19.0, 16.0, 18.0, 18.0]]},
    {"t": [0.0, 13.204, 17.684, 27.587],
     "q": [[80.0, 104.0, 19.0, 16.0, 18.0, 18.0],
           [51.6, 108.4, -24.0, 14.0, 13.4, 10.4],
           [65.6, 86.8, -45.6, 11.4, 7.2, 6.8],
           [73.0, 57.8, -47.2, 0.0, 0.0, 0.0]]}]},
  "task2_dwell2": {"dwell": 2.0, "segments": [
    {"t": [0.0, 9.431, 19.334],
     "q": [[30.0, 130.0, -60.0, 0.0, 0.0, 0.0],
           [44.4, 122.8, -20.4, 15.0, 14.4, 10.8],
           [80.0, 104.0, 19.0, 16.0, 18.0, 18.0]]},
    {"t": [0.0, 13.204, 17.684, 27.587],
     "q": [[80.0, 104.0, 19.0, 16.0, 18.0, 18.0],
           [51.6, 108.4, -24.0, 14.0, 13.4, 10.4],
           [65.6, 86.8, -45.6, 11.4, 7.2, 6.8],
           [73.0, 57.8, -47.2, 0.0, 0.0, 0.0]]}]}
}
''')


def main():
    made = {name: plan([(s["t"], s["q"]) for s in p["segments"]], p["dwell"]) for name, p in PLANS.items()}
    if "--check" in sys.argv:
        off = worst(made, json.loads(FILE.read_text()))
        print(f"largest difference {off:.2e}")
        sys.exit(off > 1e-10)
    FILE.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
