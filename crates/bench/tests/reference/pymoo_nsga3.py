"""NSGA-III of pymoo at Deb and Jain's settings (2014, tables I to III): IGD to the 91 target
points and normalised hypervolume per seed, as JSON on stdout.

    pip install pymoo==0.6.2 && python pymoo_nsga3.py 20 > moea-pymoo-nsga3.json
"""
import json
import sys

import numpy as np
import pymoo
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.indicators.hv import HV
from pymoo.indicators.igd import IGD
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.optimize import minimize
from pymoo.problems import get_problem
from pymoo.util.ref_dirs import get_reference_directions

GENERATIONS = {"dtlz1": 400, "dtlz2": 250, "dtlz3": 1000, "dtlz4": 600}
VARIABLES = {"dtlz1": 7, "dtlz2": 12, "dtlz3": 12, "dtlz4": 12}

seeds = int(sys.argv[1])
directions = get_reference_directions("das-dennis", 3, n_partitions=12)
out = {"generator": "pymoo_nsga3.py", "pymoo": pymoo.__version__, "problems": {}}
for name, generations in GENERATIONS.items():
    problem = get_problem(name, n_var=VARIABLES[name], n_obj=3)
    if name == "dtlz1":
        front = 0.5 * directions
    else:
        front = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    igd, hv = IGD(front), HV(ref_point=np.ones(3))
    rows = []
    for seed in range(1, seeds + 1):
        algorithm = NSGA3(
            ref_dirs=directions,
            pop_size=92,
            crossover=SBX(prob=1.0, eta=30),
            mutation=PM(prob=1.0, eta=20),
        )
        result = minimize(problem, algorithm, ("n_gen", generations), seed=seed)
        f = result.pop.get("F")
        rows.append({"igd": igd(f), "hv": hv(f / front.max(axis=0) / 1.1) })
        print(name, seed, rows[-1], file=sys.stderr)
    out["problems"][name] = {
        "generations": generations,
        "igd": [row["igd"] for row in rows],
        "hv": [row["hv"] for row in rows],
    }
json.dump(out, sys.stdout, indent=1)
