"""NSGA-III of pymoo and pagmo2 on DTLZ2 (three objectives, 92 members, 217 generations): evaluations
per CPU second on one core, beside `cargo bench -p hydrotrace-moea`.

    pip install pymoo==0.6.2 pygmo==2.20.0 && python moea_peers.py
"""
import time

import numpy as np
import pygmo
import pymoo
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.indicators.igd import IGD
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.optimize import minimize
from pymoo.problems import get_problem
from pymoo.util.ref_dirs import get_reference_directions

GENERATIONS, MEMBERS = 217, 92
directions = get_reference_directions("das-dennis", 3, n_partitions=12)
igd = IGD(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def with_pymoo(seed):
    algorithm = NSGA3(
        ref_dirs=directions, pop_size=MEMBERS, crossover=SBX(prob=1.0, eta=30), mutation=PM(prob=1.0, eta=20)
    )
    problem = get_problem("dtlz2", n_var=12, n_obj=3)
    return minimize(problem, algorithm, ("n_gen", GENERATIONS), seed=seed).pop.get("F")


def with_pagmo2(seed):
    problem = pygmo.problem(pygmo.dtlz(prob_id=2, dim=12, fdim=3))
    algorithm = pygmo.algorithm(
        pygmo.nsga3(
            gen=GENERATIONS - 1, cr=1.0, eta_c=30.0, mut=1 / 12, eta_mut=20.0, divisions=12, seed=seed
        )
    )
    return algorithm.evolve(pygmo.population(problem, MEMBERS, seed=seed)).get_f()


for name, run, repeats in [
    (f"pymoo {pymoo.__version__}", with_pymoo, 3),
    (f"pagmo2 {pygmo.__version__} nsga3", with_pagmo2, 20),
]:
    run(0)
    rates, quality = [], []
    for seed in range(1, repeats + 1):
        start = time.process_time()
        f = run(seed)
        rates.append(GENERATIONS * MEMBERS / (time.process_time() - start))
        quality.append(igd(f))
    print(f"{name:24} {np.median(rates):>10.0f} evaluations/s   IGD {np.median(quality):.2e}")
