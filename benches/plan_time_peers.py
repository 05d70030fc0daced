"""The fastest plans of the sample tasks by hydrotrace and by other planners, all judged by `plan_judge.py`, as a table.

    pip install numpy scipy pin ruckig toppra drake casadi
    cargo build --release && OMP_NUM_THREADS=1 python benches/plan_time_peers.py --hydrotrace target/release/hydrotrace

All keep the same limits of speed, acceleration and jerk of each joint, begin and end at rest, rest at dwells, and pass
the key points. Range, torque, rod force and pump flow are checked afterwards, of hydrotrace's plans too. A planner that
is not installed is left out, and the table says so. Each planner that needs a guess of the times gets the same.

* Ruckig takes one key point to the next. Waypoints are planned by its vendor's server, which is not asked. `sought`
  moves its speed and acceleration at each key point by Nelder-Mead, until the sum of the times falls no more.
* TOPP-RA takes cubic splines through the key points, of three measures of length and three kinds of ends; the fastest
  counts. It has no limit on jerk and its acceleration steps. `smoothed` is the quintic spline through so many of its
  samples an interval that it is the fastest once stretched.
* Drake's KinematicTrajectoryOptimization has a B-spline of sixth degree, and limits on control points, which hold
  everywhere. A path position is asked for at a given share of the path. `times free` makes these shares variables.
* Collocation is multiple shooting by CasADi and IPOPT: pieces of sixth degree, five continuous derivatives, limits at
  nodes. `equal` pieces share the time of their interval; `free` ones have their own, and begin with the equal ones.

Zero speed, acceleration and jerk at rest are asked of Drake and of collocation, as hydrotrace has them.
"""
import argparse
import importlib
import json
import resource
import subprocess
from importlib.metadata import version
from math import factorial

import numpy as np
from plan_judge import (JOINTS, ROOT, Task, from_derivatives, from_positions, from_spline, guess, judge, slower, smooth,
                        split)
from scipy.interpolate import BSpline, CubicSpline, make_lsq_spline
from scipy.optimize import minimize

DEGREE = 6


def hydrotrace(task, options, *more):
    """Its document's times and free points; the spline is solved here: sixth degree, knots between the points."""
    if options.hydrotrace is None:
        raise ImportError("no --hydrotrace")
    line = [options.hydrotrace, "plan", str(task.path), "--choose", "fastest", "--json", *more]
    run = subprocess.run(line, capture_output=True, text=True, check=False)
    if run.returncode not in (0, 3):  # 3: remarks on the task
        raise RuntimeError(run.stderr.strip())
    chosen = json.loads(run.stdout)["chosen"]
    times, via, plan, at = chosen["times_s"], chosen.get("via") or [], [], 0
    leaves = times[0]
    for leg in task.legs:
        key_s = np.array([leaves, *times[at + 1:at + len(leg.points)]])
        passed = [point for point in via if key_s[0] < point["t_s"] < key_s[-1]]
        t = np.concatenate((key_s, [point["t_s"] for point in passed]))
        points = np.vstack([leg.points] + [point["position_rad"] for point in passed])[np.argsort(t)]
        t = np.sort(t)
        knots = np.concatenate(([t[0]] * 7, (t[1:] + t[:-1]) / 2, [t[-1]] * 7))
        control = np.vstack([points[:1].repeat(4, 0), np.zeros((len(points) - 2, JOINTS)), points[-1:].repeat(4, 0)])
        basis = BSpline.design_matrix(t[1:-1], knots, DEGREE).toarray()
        control[4:-4] = np.linalg.solve(basis[:, 4:-4], points[1:-1] - basis @ control)
        plan.append((from_spline(BSpline(knots, control, DEGREE)), key_s))
        at += len(leg.points) - 1
        leaves = times[at] + leg.dwell_s
    return plan


def ruckig_part(task, a, b, at_a, at_b):
    """From one key point to the next; speed and acceleration at both as shares of their limits."""
    import ruckig
    given, found = ruckig.InputParameter(JOINTS), ruckig.Trajectory(JOINTS)
    given.current_position, given.target_position = a, b
    given.current_velocity, given.target_velocity = at_a[:6] * task.speed, at_b[:6] * task.speed
    given.current_acceleration, given.target_acceleration = at_a[6:] * task.acceleration, at_b[6:] * task.acceleration
    given.max_velocity, given.max_acceleration, given.max_jerk = task.speed, task.acceleration, task.jerk
    try:
        # A start from which the speed limit cannot be kept is not refused otherwise.
        given.validate(check_current_state_within_limits=True)
        return found if ruckig.Ruckig(JOINTS).calculate(given, found) == ruckig.Result.Working else None
    except ruckig.RuckigError:  # there is no way between these states
        return None


def ruckig_s(task, *states):
    """Duration, and a penalty where the arm leaves its range."""
    part = ruckig_part(task, *states)
    if part is None:
        return 1e3
    low, high = np.array([[bound.min, bound.max] for bound in part.position_extrema]).T
    return part.duration + 100 * (np.maximum(task.low - low, 0) + np.maximum(high - task.high, 0)).sum()


def ruckig_through(task, leg, states):
    """Exact: jerk is constant between the switches of a joint."""
    breaks, values, key_s = [], [], [0.0]
    for state in zip(leg.points, leg.points[1:], states, states[1:]):
        part = ruckig_part(task, *state)
        switches = [np.cumsum(np.concatenate((p.brake.t, p.t, p.accel.t))) for p in part.profiles[0]]
        t = np.unique(np.concatenate([[0.0]] + switches))
        t = t[np.append(True, np.diff(t) > 1e-9) & (t < part.duration - 1e-9)]
        width = np.append(t[1:], part.duration) - t
        q, qd, qdd = np.array([part.at_time(at) for at in t + width / 4]).swapaxes(0, 1)
        later = np.array([part.at_time(at)[2] for at in t + 3 * width / 4])
        jerk, back = 2 * (later - qdd) / width[:, None], -width[:, None] / 4
        values.append([q + qd * back + qdd * back**2 / 2 + jerk * back**3 / 6,
                       qd + qdd * back + jerk * back**2 / 2, qdd + jerk * back, jerk])
        breaks.append(key_s[-1] + t)
        key_s.append(key_s[-1] + part.duration)
    return from_derivatives(np.append(np.concatenate(breaks), key_s[-1]), np.concatenate(values, 1)), np.array(key_s)


def ruckig_stop(task, leg, _):
    return ruckig_through(task, leg, np.zeros((len(leg.points), 2 * JOINTS)))


def ruckig_sought(task, leg, _):
    """Starts with three multiples of a spline's slopes."""
    points, found = leg.points, []
    t, _ = guess(task, leg)
    slopes = CubicSpline(t, points, bc_type="clamped")(t[1:-1], 1) / task.speed
    for share in 0.3, 0.6, 0.9:
        states = np.zeros((len(points), 2 * JOINTS))
        states[1:-1, :JOINTS] = share * slopes / np.abs(slopes).max(axis=1, keepdims=True)
        last, total = np.inf, 1e6
        while last - total > 1e-3:
            for i in range(1, len(points) - 1):
                def cost(x):
                    return (ruckig_s(task, points[i - 1], points[i], states[i - 1], x)
                            + ruckig_s(task, points[i], points[i + 1], x, states[i + 1]))
                for step in 0.2, -0.2:
                    simplex = np.clip(states[i] + np.vstack([np.zeros(12), step * np.eye(12)]), -1, 1)
                    way = {"initial_simplex": simplex, "adaptive": True, "maxfev": 2000}
                    best = minimize(cost, states[i], method="Nelder-Mead", bounds=[(-1, 1)] * 12, options=way)
                    if best.fun < cost(states[i]):
                        states[i] = best.x
            last, total = total, sum(ruckig_s(task, *s) for s in zip(points, points[1:], states, states[1:]))
        found.append((total, states))
    return ruckig_through(task, leg, min(found, key=lambda pair: pair[0])[1])


def toppra_of(task, leg, power, ends, grid=100):
    """On one path: the arrivals at its grid, and the curve."""
    import toppra
    from toppra import algorithm, constraint
    length = (np.abs(np.diff(leg.points, axis=0)) / task.speed).max(axis=1)**power
    key = np.concatenate(([0.0], np.cumsum(length / length.mean())))
    path, s = toppra.SplineInterpolator(key, leg.points, ends), split(key, grid)
    limits = [constraint.JointVelocityConstraint(task.speed), constraint.JointAccelerationConstraint(
        task.acceleration, discretization_scheme=constraint.DiscretizationType.Interpolation)]
    _, sd, _ = algorithm.TOPPRA(limits, path, gridpoints=s).compute_parameterization(0, 0)
    if sd is None or np.isnan(sd).any():
        return None
    step, t = np.diff(s), np.concatenate(([0.0], np.cumsum(2 * np.diff(s) / (sd[1:] + sd[:-1]))))

    def position(at):
        i = np.clip(np.searchsorted(t, at, "right") - 1, 0, len(step) - 1)
        dt = at - t[i]
        return path(s[i] + sd[i] * dt + (sd[i + 1]**2 - sd[i]**2) / (4 * step[i]) * dt**2)
    return t, position, t[::grid]


def toppra_all(task, leg):
    found = [toppra_of(task, leg, power, ends) for power in (0.0, 0.5, 1.0)
             for ends in ("natural", "clamped", "not-a-knot")]
    return [plan for plan in found if plan]


def toppra_fastest(task, leg, _):
    t, position, key_s = min(toppra_all(task, leg), key=lambda plan: plan[0][-1])
    return from_positions(t, position, DEGREE), key_s


def toppra_smoothed(task, leg, _):
    def held(pair):
        return slower(task, pair[0]) * pair[0].t[-1]
    found = []
    for _, position, key_s in toppra_all(task, leg):
        for samples in 1, 2, 3, 4, 6, 8, 12, 16, 24, 32:
            t = split(key_s, samples)
            found.append((smooth(t, position(t)), key_s))
    curve, key_s = min(found, key=held)
    return from_spline(curve), key_s


def drake(task, leg, _, count, free):
    """Knots lie evenly in the intervals of the guess; SNOPT."""
    from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff
    from pydrake.math import BsplineBasis
    from pydrake.planning import KinematicTrajectoryOptimization
    from pydrake.solvers import SnoptSolver
    from pydrake.trajectories import BsplineTrajectory
    points, (key_s, start) = leg.points, guess(task, leg)
    share, duration_s = key_s / key_s[-1], key_s[-1]
    spans = count * (len(points) - 1)
    inner = np.linspace(0, 1, spans + 1) if free else split(share, count)
    knots = np.concatenate(([0.0] * DEGREE, inner, [1.0] * DEGREE))
    at = np.linspace(0, 1, 50 * spans)
    control = make_lsq_spline(at, start(at * duration_s), knots, DEGREE).c
    first = BsplineTrajectory(BsplineBasis(DEGREE + 1, list(knots)), [c[:, None] for c in control])
    problem = KinematicTrajectoryOptimization(first)
    program, points_of = problem.get_mutable_prog(), problem.control_points()
    program.SetInitialGuess(problem.duration(), duration_s)
    problem.AddDurationCost(1.0)
    problem.AddDurationConstraint(duration_s / 10, 10 * duration_s)
    problem.AddPositionBounds(task.low, task.high)
    problem.AddVelocityBounds(-task.speed, task.speed)
    problem.AddAccelerationBounds(-task.acceleration, task.acceleration)
    problem.AddJerkBounds(-task.jerk, task.jerk)
    for i in range(4):  # rest, without jerk
        program.AddBoundingBoxConstraint(points[0], points[0], points_of[:, i])
        program.AddBoundingBoxConstraint(points[-1], points[-1], points_of[:, -1 - i])

    def through(x):
        """Position at the share x[0] of the path, and its slopes."""
        value = ExtractValue(x).ravel() if x.dtype == object else x
        spline = BSpline(knots, value[1:].reshape(control.shape), DEGREE)
        if x.dtype != object:
            return spline(value[0])
        basis = BSpline.design_matrix(value[:1], knots, DEGREE).toarray()
        slopes = np.hstack([spline(value[0], 1)[:, None], np.kron(basis, np.eye(JOINTS))])
        return InitializeAutoDiff(spline(value[0])[:, None], slopes @ ExtractGradient(x)).ravel()
    shares = program.NewContinuousVariables(len(points) - 2) if free else []
    if free:
        program.AddBoundingBoxConstraint(0.01, 0.99, shares)
        program.SetInitialGuess(shares, share[1:-1])
    for i, point in enumerate(points[1:-1]):
        if free:
            program.AddConstraint(through, point, point, np.concatenate(([shares[i]], points_of.T.ravel())))
        else:
            problem.AddPathPositionConstraint(point, point, share[i + 1])
    found = SnoptSolver().Solve(program)
    if not found.is_success():
        raise RuntimeError(str(found.get_solution_result()))
    inside = found.GetSolution(shares) if free else share[1:-1]
    duration_s = found.GetSolution(problem.duration())
    curve = BSpline(knots * duration_s, found.GetSolution(points_of).T, DEGREE)
    return from_spline(curve), duration_s * np.concatenate(([0.0], inside, [1.0]))


def shoot(task, leg, pieces, free, start):
    """Collocation from a start `(duration of each piece, derivatives at each end of one)`; the same of its solution."""
    import casadi as ca
    wide, states = start
    count, size, unit = len(wide), DEGREE * JOINTS, wide.mean()
    scale = unit ** -np.arange(DEGREE + 1.0)  # a piece takes about one unit of time
    x, u, h = ca.SX.sym("x", DEGREE, JOINTS), ca.SX.sym("u", 1, JOINTS), ca.SX.sym("h")
    taylor = ca.vertcat(x, u)

    def after(part, k):
        return sum(taylor[e, :] * (h * part)**(e - k) / factorial(e - k) for e in range(k, DEGREE + 1))
    bounds = [1 / task.speed, 1 / task.acceleration, 1 / task.jerk]
    # Between these nodes a limit is exceeded by some tenths of a percent.
    nodes = {1: 12, 2: 16, 3: 24}
    shares = [after(i / of, k) * ca.DM(bounds[k - 1] * scale[k]).T for k, of in nodes.items() for i in range(of + 1)]
    ranges = [(after(i / 8, 0) - ca.DM((task.high + task.low) / 2).T) * ca.DM(2 / (task.high - task.low)).T
              for i in range(1, 8)]
    piece = ca.Function("piece", [x, u, h], [ca.vec(ca.vertcat(*[after(1, k) for k in range(DEGREE)])),
                                             ca.vec(ca.vertcat(*shares, *ranges))])
    state = [ca.MX.sym("x", DEGREE, JOINTS) for _ in range(count + 1)]
    sixth, width = [ca.MX.sym("u", 1, JOINTS) for _ in range(count)], ca.MX.sym("h", count if free else count // pieces)
    ends = [piece(state[i], sixth[i], width[i if free else i // pieces]) for i in range(count)]
    joins = ca.vertcat(*[end - ca.vec(state[i + 1]) for i, (end, _) in enumerate(ends)])
    held = ca.vertcat(*[share for _, share in ends])
    fixed = np.full((count + 1, DEGREE, JOINTS), np.nan)
    fixed[::pieces, 0] = leg.points
    fixed[[0, -1], 1:4] = 0
    fixed = np.concatenate([f.ravel("F") for f in fixed])
    low, high = (np.where(np.isnan(fixed), bound, fixed) for bound in (-np.inf, np.inf))
    rest = count * JOINTS
    low = np.concatenate([low, np.full(rest, -np.inf), np.full(width.shape[0], 0.02)])
    high = np.concatenate([high, np.full(rest, np.inf), np.full(width.shape[0], 20.0)])
    begin = np.concatenate([(s[:DEGREE] / scale[:DEGREE, None]).ravel("F") for s in states]
                           + [s[DEGREE] / scale[DEGREE] for s in states[:-1]]
                           + [(wide if free else wide[::pieces]) / unit])
    quiet = {"print_time": 0, "ipopt": {"print_level": 0, "sb": "yes", "max_iter": 1000, "mu_strategy": "adaptive"}}
    problem = {"x": ca.vertcat(*[ca.vec(s) for s in state], *[ca.vec(s) for s in sixth], width),
               "f": ca.sum1(width), "g": ca.vertcat(joins, held)}
    solve = ca.nlpsol("solve", "ipopt", problem, quiet)
    zero, one = np.zeros(joins.shape[0]), np.ones(held.shape[0])
    found = solve(x0=begin, lbx=low, ubx=high, lbg=np.concatenate([zero, -one]), ubg=np.concatenate([zero, one]))
    if not solve.stats()["success"]:
        return None
    found = np.array(found["x"]).ravel()
    wide = found[size * (count + 1) + rest:] * unit
    wide = wide if free else wide.repeat(pieces)
    ends = found[:size * (count + 1)].reshape(count + 1, JOINTS, DEGREE).swapaxes(1, 2)
    sixth = np.append(found[size * (count + 1):][:rest], np.zeros(JOINTS)).reshape(count + 1, 1, JOINTS)
    return wide, np.concatenate([ends, sixth], axis=1) * scale[:, None]


def collocation(task, leg, options, pieces, free):
    t, _ = guess(task, leg)
    random, found = np.random.default_rng(1), []
    for i in range(options.starts):
        times = np.concatenate(([0.0], np.cumsum(np.diff(t) * (random.uniform(0.6, 1.4, len(t) - 1) if i else 1))))
        times *= slower(task, smooth(times, leg.points))
        breaks, curve = split(times, pieces), smooth(times, leg.points)
        states = np.stack([curve(breaks, order) for order in range(DEGREE)] + [np.zeros((len(breaks), JOINTS))], 1)
        found.append(shoot(task, leg, pieces, False, (np.diff(breaks), states)))
    found = [one for one in found if one]
    if free:
        found = [one for one in (shoot(task, leg, pieces, True, start) for start in found) if one] or found
    if not found:
        raise RuntimeError("IPOPT found no plan")
    wide, states = min(found, key=lambda one: one[0].sum())
    breaks = np.concatenate(([0.0], np.cumsum(wide)))
    return from_derivatives(breaks, states[:-1].swapaxes(0, 1)), breaks[::pieces]


def peers(options):
    """Name, package and planner of each row."""
    def legs(planner, *more):
        return lambda task: [planner(task, leg, options, *more) for leg in task.legs]
    yield "hydrotrace, times", None, lambda task: hydrotrace(task, options)
    yield "hydrotrace, free shape", None, lambda task: hydrotrace(task, options, "--shape", "free")
    yield ("hydrotrace, free, 30 pieces", None,
           lambda task: hydrotrace(task, options, "--shape", "free", "--pieces", "30"))
    yield "Ruckig, stops at key points", "ruckig", legs(ruckig_stop)
    yield "Ruckig, sought", "ruckig", legs(ruckig_sought)
    yield "TOPP-RA", "toppra", legs(toppra_fastest)
    yield "TOPP-RA, smoothed", "toppra", legs(toppra_smoothed)
    fixed = options.spans[:2][-1]
    yield f"Drake, {fixed} spans, times fixed", "pydrake", legs(drake, fixed, False)
    for spans in options.spans:
        yield f"Drake, {spans} spans, times free", "pydrake", legs(drake, spans, True)
    for pieces in options.pieces:
        yield f"collocation, {pieces} equal pieces", "casadi", legs(collocation, pieces, False)
    yield f"collocation, {options.pieces[-1]} free pieces", "casadi", legs(collocation, options.pieces[-1], True)


def cpu_s():
    return sum(use.ru_utime + use.ru_stime for use in map(resource.getrusage, (resource.RUSAGE_SELF,
                                                                               resource.RUSAGE_CHILDREN)))


def row(task, package, planner):
    try:
        if package:
            importlib.import_module(package)
        begin = cpu_s()
        plan = planner(task)
        spent = cpu_s() - begin
    except (ImportError, RuntimeError) as error:
        return f"left out: {error} | | | | | |"
    found = judge(task, plan)
    share = f"{100 * found.worst_share:.1f} %" if np.isfinite(found.worst_share) else "without bound"
    held, jerk = ((f"{found.held_s:.3f}", f"{found.rms_jerk:.2f}") if np.isfinite(found.held_s) else ("never", "-"))
    missed = "" if found.key_error_deg < 1e-3 else f", misses key points by {found.key_error_deg:.2g} deg"
    return (f"{found.least_s:.3f} | {held} | {found.worst} {share}{missed} | {found.smooth}, {found.at_rest} | "
            f"{jerk} | {spent:.3g} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--hydrotrace", help="the program; without it its rows are left out")
    parser.add_argument("--tasks", nargs="+", default=["simulation", "task-1", "task-2"])
    parser.add_argument("--only", default="", help="rows whose name holds this")
    parser.add_argument("--pieces", nargs="+", type=int, default=[2, 3, 4], help="of an interval, by collocation")
    parser.add_argument("--starts", type=int, default=3, help="of collocation")
    parser.add_argument("--spans", nargs="+", type=int, default=[6, 40, 60], help="of an interval, by Drake")
    options = parser.parse_args()
    packages = []
    for name in "numpy", "scipy", "pin", "ruckig", "toppra", "drake", "casadi":
        try:
            packages.append(f"{name} {version(name)}")
        except importlib.metadata.PackageNotFoundError:
            packages.append(f"{name} not installed")
    print(", ".join(packages) + "\n")
    print("| task | planner | minimum time s | held s | worst limit | continuous | RMS jerk deg/s3 | CPU s |")
    print("|---|---|---:|---:|---|---:|---:|---:|", flush=True)
    for name in options.tasks:
        task = Task(ROOT / f"sample-logs/tasks/{name}.toml")
        for title, package, planner in peers(options):
            if options.only in title:
                print(f"| {name} | {title} | {row(task, package, planner)}", flush=True)


if __name__ == "__main__":
    main()
