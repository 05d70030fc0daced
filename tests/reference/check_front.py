"""Judges a front of plans with SciPy and Pinocchio.

    pip install numpy scipy pin
    hydrotrace plan TASK.toml --json > FRONT.json
    OMP_NUM_THREADS=1 python tests/reference/check_front.py FRONT.json TASK.toml [--sample 40] [--seed 1] [--jobs 1]

FRONT.json has `front[]` with `times_s`, `duration_s`, `rms_jerk_rad_s3`, `rms_power_w`, `violation`.
Objectives and peaks of every plan are computed anew. From a sample of the plans, SciPy's SLSQP then looks
for plans that are nowhere worse and keep all limits: from the plan itself and from perturbed copies of it,
lessening each objective in turn. The check fails (exit 1) if

* an objective differs by more than 1e-5 of its value,
* a plan exceeds limits by more than 0.1 % in all beyond what the file admits, or
* a plan that dominates a sampled one is better by more than 1 % in some objective.
"""

import argparse
import sys
from multiprocessing import Pool

import numpy as np

from plan_model import FINE, Model, descend, feasible, read

OBJECTIVES = ["duration_s", "rms_jerk_rad_s3", "rms_power_w"]
DIFFERENCE, EXCESS, BETTER = 1e-5, 1e-3, 0.01
# Copies of a plan to start from, and by how much their intervals differ, as logarithms.
COPIES, SPREAD = 2, 0.15
# What a better plan may exceed a limit or an objective by: descents see peaks at fewer instants.
HAIR = 1e-5


def compare(model, front):
    """Relative differences of the objectives, excesses here, and excesses by the file; by plan."""
    differences, here, there = [], [], []
    for plan in front:
        f, peaks = model.evaluate(model.intervals_s(np.array(plan["times_s"])), FINE)
        given = np.array([plan[name] for name in OBJECTIVES])
        differences.append(np.abs(f - given) / f)
        here.append(model.violation(peaks))
        there.append(plan["violation"])
    return np.array(differences), np.array(here), np.array(there)


def improve(model, plan, seed):
    """By objective the largest gain that a feasible plan has in it which is nowhere worse."""
    own_s = model.intervals_s(np.array(plan["times_s"]))
    ceilings, _ = model.evaluate(own_s, FINE)
    rng = np.random.default_rng(seed)
    starts = [own_s] + [own_s * np.exp(rng.normal(0, SPREAD, model.n)) for _ in range(COPIES)]
    best = np.zeros(3)
    for k in range(3):
        for start in starts:
            f, holds = feasible(model, descend(model, start, np.eye(3)[k], ceilings), HAIR)
            gain = 1 - f / ceilings
            if holds and gain.min() >= -HAIR:
                best = np.maximum(best, gain)
    return best


def task(job):
    path, index, plan = job
    return index, improve(Model(path), plan, index)


def main():
    parser = argparse.ArgumentParser(description="Judges a front of plans with SciPy and Pinocchio.")
    parser.add_argument("front")
    parser.add_argument("task")
    parser.add_argument("--sample", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    front, model = read(arguments.front)["front"], Model(arguments.task)

    differences, here, there = compare(model, front)
    print(f"{len(front)} plans; largest difference of an objective, as a share of it:")
    for name, off in zip(OBJECTIVES, differences.max(axis=0)):
        print(f"  {name:16} {off:.1e}")
    excess = np.maximum(here - there, 0)
    print(f"{(here > 1e-6).sum()} plans exceed a limit; most beyond what the file says: {excess.max():.1e}\n")

    rng = np.random.default_rng(arguments.seed)
    chosen = sorted(rng.choice(len(front), min(arguments.sample, len(front)), replace=False))
    # The ends of the front are always among them.
    values = np.array([[plan[name] for name in OBJECTIVES] for plan in front])
    chosen = sorted({int(i) for i in [*chosen, *values.argmin(axis=0)]})
    jobs = [(arguments.task, i, front[i]) for i in chosen]
    with Pool(arguments.jobs) as pool:
        found = pool.map(task, jobs, chunksize=1)
    print("plan   f1, s     f2, rad/s^3   f3, W      better by, %: f1       f2       f3  (each alone)")
    for i, gain in found:
        f1, f2, f3 = values[i]
        print(f"{i:4} {f1:9.4f} {f2:12.6g} {f3:10.4f}          " + " ".join(f"{100 * g:8.4f}" for g in gain))
    gains = np.array([gain.max() for _, gain in found])
    print(f"\n{len(found)} plans: dominated by up to {100 * gains.max():.3f} %, in the median {100 * np.median(gains):.4f} %")
    # Where objectives trade steeply, a large gain in one is a tiny loss of another.
    least = max(gain.min() for _, gain in found)
    print(f"by the objective that each gains least in, up to {100 * least:.3f} %")

    faults = []
    if differences.max() > DIFFERENCE:
        faults.append(f"an objective differs by {differences.max():.1e}, allowed are {DIFFERENCE}")
    if excess.max() > EXCESS:
        faults.append(f"a limit is exceeded by {excess.max():.1e} more than the file says, allowed are {EXCESS}")
    if gains.max() > BETTER:
        faults.append(f"a plan is dominated by {100 * gains.max():.2f} %, allowed is {100 * BETTER:.0f} %")
    print("\n".join(faults) or "passed")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
