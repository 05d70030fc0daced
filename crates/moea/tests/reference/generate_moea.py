"""Reference values for src/moea, as JSON on stdout.

    pip install pymoo==0.6.2 moocore==0.3.2 numba && python generate_moea.py > moea-values.json
"""
import json
import sys

import moocore
import numpy as np
import pymoo
from pymoo.algorithms.moo.age2 import AGEMOEA2Survival, find_zero
from pymoo.algorithms.moo.sms import LeastHypervolumeContributionSurvival
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.indicators.igd import IGD
from pymoo.indicators.igd_plus import IGDPlus
from pymoo.problems import get_problem
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting
from pymoo.util.ref_dirs import get_reference_directions

random = np.random.default_rng(20140801)
out = {
    "generator": "generate_moea.py",
    "pymoo": pymoo.__version__,
    "moocore": "0.3.2",
    "problems": [],
    "sorting": [],
    "hypervolume": [],
    "distance": [],
    "directions": [],
    "survival": [],
}

for name in [f"dtlz{i}" for i in range(1, 8)] + [f"wfg{i}" for i in range(1, 10)]:
    for m in (2, 3, 5):
        distances = {"dtlz1": 5, "dtlz7": 20}.get(name, 10)
        # pymoo refuses fewer than four positions of WFG.
        positions = max(4, m - 1) if name.startswith("wfg") else m - 1
        d = positions + distances
        extra = {"k": positions, "l": distances} if name.startswith("wfg") else {}
        problem = get_problem(name, n_var=d, n_obj=m, **extra)
        lower, upper = np.asarray(problem.xl), np.asarray(problem.xu)
        x = lower + random.random((5, d)) * (upper - lower)
        f = problem.evaluate(x)
        out["problems"].append({"name": name.upper(), "positions": positions, "x": x.tolist(), "f": f.tolist()})

for m, n, levels in [(2, 40, 6), (3, 60, 5), (3, 50, 1000), (4, 50, 8), (6, 40, 4)]:
    f = random.integers(0, levels, (n, m)).astype(float)
    fronts = NonDominatedSorting().do(f)
    rank = np.empty(n, dtype=int)
    for r, front in enumerate(fronts):
        rank[front] = r
    out["sorting"].append({"f": f.tolist(), "rank": rank.tolist()})

for m, n in [(2, 30), (3, 60), (4, 30), (5, 20), (6, 12)]:
    for kind in ("random", "front", "ties"):
        f = random.random((n, m))
        if kind == "front":
            f = f / np.linalg.norm(f, axis=1, keepdims=True)
        if kind == "ties":
            f = np.round(f * 4) / 4
        reference = np.full(m, 1.1 if kind == "front" else 0.9)
        out["hypervolume"].append(
            {"f": f.tolist(), "reference": reference.tolist(), "value": moocore.hypervolume(f, ref=reference)}
        )

for m in (2, 3, 5):
    f, z = random.random((20, m)), random.random((30, m))
    out["distance"].append(
        {"f": f.tolist(), "front": z.tolist(), "igd": IGD(z)(f), "igd_plus": IGDPlus(z)(f)}
    )

for m, p in [(2, 9), (3, 12), (5, 4)]:
    z = get_reference_directions("das-dennis", m, n_partitions=p)
    out["directions"].append({"m": m, "p": p, "points": sorted(z.tolist())})



class Corrected(AGEMOEA2Survival):
    """Scores as in the author's program: distances divided by the member's own norm, not by its neighbours'.
    The exponent is that of the point whose largest objective is least, not of the one nearest to the ideal."""

    @staticmethod
    def compute_geometry(front, extreme, n):
        largest = front.max(axis=1)
        largest[extreme] = np.inf
        p = find_zero(front[np.argmin(largest)], n, 0.001)
        return 1.0 if np.isnan(p) or p <= 0.1 else min(p, 20.0)

    @staticmethod
    def pairwise_distances(front, p):
        norm = np.linalg.norm(front, p, axis=1)
        return AGEMOEA2Survival.pairwise_distances(front, p) * norm[:, None] / norm[None, :]


def front(n, m, exponent, noise):
    """Points about a surface, none of them dominated; its corners, too, unless far from it."""
    f = random.dirichlet(np.ones(m), 20 * n)
    if noise < 0.3:
        f = np.vstack([np.eye(m), f])
    f = f / np.sum(f**exponent, axis=1, keepdims=True) ** (1 / exponent)
    f = f * (1 + noise * random.random((len(f), 1)))
    return f[NonDominatedSorting().do(f, only_non_dominated_front=True)[:n]]


def unit_range(f):
    """The first front of `f` ranges from 0 to 1: pymoo looks for corners in the units of the objectives."""
    first = f[NonDominatedSorting().do(f, only_non_dominated_front=True)]
    return (f - first.min(axis=0)) / (first.max(axis=0) - first.min(axis=0))


def survivors(survival, f, keep):
    pop = Population.new(F=f, G=np.zeros((len(f), 0)), H=np.zeros((len(f), 0)), index=np.arange(len(f)))
    pop = survival.do(Problem(n_var=1, n_obj=f.shape[1]), pop, n_survive=keep)
    return sorted(int(i) for i in pop.get("index"))


# Not a line of two objectives: there, all first choices are equal.
surfaces = [(2, 40, 0.5), (2, 40, 3.0), (3, 60, 0.5), (3, 60, 1.0), (3, 60, 2.0), (4, 60, 2.0), (5, 50, 1.0)]
for m, n, exponent in surfaces:
    for noise in (0.0, 0.02, 0.3):
        f = unit_range(front(n, m, exponent, noise))
        # On the surface itself all norms are 1, and pymoo as it is keeps nearly the same.
        out["survival"].append(
            {
                "algorithm": "age-moea-2",
                "f": f.tolist(),
                "keep": len(f) // 2,
                "kept": survivors(Corrected(), f.copy(), len(f) // 2),
                "pymoo": survivors(AGEMOEA2Survival(), f.copy(), len(f) // 2),
            }
        )
for m, n in [(2, 40), (3, 40), (3, 80), (4, 40)]:
    for kind in ("front", "random"):
        f = front(n, m, 2.0, 0.1) if kind == "front" else random.random((n, m))
        keep = len(f) // 2
        kept = survivors(LeastHypervolumeContributionSurvival(), f.copy(), keep)
        out["survival"].append({"algorithm": "sms-emoa", "f": f.tolist(), "keep": keep, "kept": kept})

for name, m in [("mw1", 2), ("mw2", 2), ("mw3", 2), ("mw4", 2), ("mw4", 3), ("mw4", 5)]:
    problem = get_problem(name, n_var=15, **({"n_obj": m} if name == "mw4" else {}))
    x = random.random((20, 15))
    f, g = problem.evaluate(x, return_values_of=["F", "G"])
    out["problems"].append(
        {
            "name": name.upper(),
            "positions": m - 1,
            "x": x.tolist(),
            "f": f.tolist(),
            "violation": np.maximum(g, 0.0).sum(axis=1).tolist(),
        }
    )

json.dump(out, sys.stdout)
