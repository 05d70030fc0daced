"""Writes plan-optima.json: the best plans of the three tasks, found with SciPy and Pinocchio.

    pip install numpy scipy pin
    OMP_NUM_THREADS=1 python tests/reference/plan_optima.py

Of every task the fastest, the smoothest and the thriftiest plan (least f1, f2, f3): the best of SLSQP
from many starts and of differential evolution, which knows no slopes. For a row of durations between
them the plan that is smoothest, thriftiest, and best in the product of both. The plans of the paper
besides. Takes minutes; made with SciPy 1.17.1, NumPy 2.4.6, Pinocchio 4.1.0.
"""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from plan_model import FINE, TASKS, Model, descend, feasible

FILE = Path(__file__).with_name("plan-optima.json")
STARTS, SEED = 40, 1
EVOLUTION = {"popsize": 15, "maxiter": 250, "tol": 0.0, "atol": 0.0, "polish": False}
ENDS = {"fastest": 0, "smoothest": 1, "thriftiest": 2}
# Durations as multiples of the fastest; those beyond the longest intervals are left out.
DURATIONS = [1.02, 1.06, 1.12, 1.2, 1.3, 1.45, 1.65, 1.9, 2.3, 2.8, 3.5, 4.5, 6.0, 8.0, 11.0, 14.0]
# Weights of the objectives' logarithms.
MIXES = [[0, 1, 0], [0, 0.5, 0.5], [0, 0, 1]]
# Errors of coarse peaks, and how many ends are worth fine ones.
ROUGH, PROMISING = 1e-3, 2

# Arrivals, s, of the paper: table 2, task 1, task 2 with the dwell as printed.
PRINTED = {
    "simulation": {"A": [0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48],
                   "B": [0, 3.51, 7.34, 10.91, 13.31, 15.32, 18.94],
                   "C": [0, 1.51, 5.09, 10.23, 15.67, 18.98, 23.27]},
    "task-1": {"task 1": [0, 7.744, 15.307, 22.863, 30.976, 38.72]},
    "task-2": {"task 2": [0, 9.431, 19.334, 34.66, 39.14, 49.043]},
}
PRINTED_DWELL_S = {"task 2": 2.122}


def best_of(model, starts_s, weights, ceilings=(np.inf,) * 3):
    """The best end of descents, and where all of them ended: with coarse peaks first, the most promising
    then with fine ones. Objectives go with the intervals."""
    merit = lambda end: np.asarray(weights) @ np.log(end[1])
    rough = [descend(model, start, weights, ceilings) for start in starts_s]
    rough = [(x, *model.evaluate(x)) for x in rough]
    rough = [(x, f) for x, f, peaks in rough
             if peaks.max() < 1 + ROUGH and (f < np.multiply(ceilings, 1 + ROUGH)).all()]
    fine = []
    for x, _ in sorted(rough, key=merit)[:PROMISING]:
        x = descend(model, x, weights, ceilings, steps=FINE, iterations=30)
        f, holds = feasible(model, x)
        if holds and (f <= np.multiply(ceilings, 1 + 1e-9)).all():
            fine.append((x, f))
    return min(fine, key=merit, default=None), rough


def starts(model, rng, count):
    """Random intervals, all over the box and about an even plan."""
    for i in range(count):
        low, high = model.box
        wide = rng.uniform(low, high, model.n)
        even = rng.uniform(low, high) + rng.normal(0, 0.3, model.n)
        yield np.exp(np.clip(wide if i % 2 else even, low, high))


def evolved(model, k):
    """The plan of least f_k by differential evolution, broken limits before all."""
    def cost(x):
        f, peaks = model.evaluate(np.exp(x))
        excess = np.maximum(peaks.max(axis=1) - 1, 0).sum()
        return 100 + excess if excess > 0 else np.log(f[k])

    found = differential_evolution(cost, [tuple(model.box)] * model.n, rng=SEED, **EVOLUTION)
    return np.exp(found.x), float(np.exp(found.fun))


def end(model, name, k, rng):
    """The best plan in one objective and how it was found."""
    best, ends = best_of(model, starts(model, rng, STARTS), np.eye(3)[k])
    same = sum(f[k] < best[1][k] * 1.0001 for _, f in ends)
    raw, value = evolved(model, k)
    polished, _ = best_of(model, [raw], np.eye(3)[k])
    print(f"  {name:11} SLSQP {best[1][k]:.9g} ({same} of {STARTS} starts, {len(ends)} feasible)   "
          f"differential evolution {value:.9g}, then SLSQP {polished[1][k] if polished else np.nan:.9g}")
    return model.describe(min((e for e in (best, polished) if e), key=lambda e: e[1][k])[0])


def front(model, fastest_s, rng):
    """Plans of given durations, each by continuation from its neighbour, from the fastest and from random
    starts."""
    longest = model.n * np.exp(model.box[1]) + model.rest_s
    durations = [d * (fastest_s.sum() + model.rest_s) for d in DURATIONS]
    durations = [d for d in durations if d < 0.97 * longest] + [0.97 * longest]
    plans = []
    for weights in MIXES:
        for duration in durations:
            near = [fastest_s, *plans[-1:], *starts(model, rng, 6)]
            scaled = [s * (duration - model.rest_s) / s.sum() for s in near]
            plans.append(best_of(model, scaled, weights, (duration, np.inf, np.inf))[0][0])
    return [model.describe(plan) for plan in plans]


def written(value, depth=0):
    """JSON with a plan a line."""
    if "times_s" in value:
        return json.dumps(value)
    if isinstance(value, dict):
        (opening, closing), items = "{}", [(f"{json.dumps(key)}: ", item) for key, item in value.items()]
    else:
        (opening, closing), items = "[]", [("", item) for item in value]
    lines = ",\n".join(" " * (depth + 1) + key + written(item, depth + 1) for key, item in items)
    return f"{opening}\n{lines}\n{' ' * depth}{closing}" + ("" if depth else "\n")


def main():
    tasks = {}
    for task, printed in PRINTED.items():
        print(task)
        rng = np.random.default_rng(SEED)
        path = TASKS / f"{task}.toml"
        model = Model(path)
        plans = {}
        for name, times in printed.items():
            own = Model(path, PRINTED_DWELL_S.get(name))
            plans[name] = own.describe(own.intervals_s(np.array(times, float)))
            if name in PRINTED_DWELL_S:
                plans[name]["dwell_s"] = PRINTED_DWELL_S[name]
            shown = [np.rad2deg(plans[name]["rms_jerk_rad_s3"]), plans[name]["rms_power_w"]]
            print(f"  {name}: {plans[name]['duration_s']:.3f} s  {shown[0]:.6g} deg/s^3  {shown[1]:.2f} W")
        optima = {name: end(model, name, k, rng) for name, k in ENDS.items()}
        fastest_s = model.intervals_s(np.array(optima["fastest"]["times_s"]))
        tasks[task] = {"printed": plans, "optima": optima, "between": front(model, fastest_s, rng)}
        sys.stdout.flush()
    FILE.write_text(written(tasks))


if __name__ == "__main__":
    main()
