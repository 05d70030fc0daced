"""Reference values for src/moea, as JSON on stdout.

    pip install pymoo==0.6.2 moocore==0.3.2 && python generate_moea.py > moea-values.json
"""
import json
import sys

import moocore
import numpy as np
import pymoo
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

json.dump(out, sys.stdout)
