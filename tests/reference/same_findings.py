#!/usr/bin/env python3
"""Compares what two builds of hydrotrace find in the sample logs, number by number.

    same_findings.py write target/release/hydrotrace NEW     documents of every verb, in folder NEW
    same_findings.py compare OLD NEW                          differences by key; exit 1 if a number differs

A key may be renamed or added, never lose or change its number: RENAMED lists the renamed ones.
"""

import csv
import json
import os
import pathlib
import re
import subprocess
import sys

LOGS = pathlib.Path("sample-logs")
# New key: old key. Endings of units fall where the unit is the joint's own.
RENAMED = {
    "unanswered_starts": "unmatched_starts",
    "undated_starts": "untimed_starts",
}
OBJECTIVES = ["duration_s", "rms_jerk_rad_s3", "rms_power_w"]
# Texts and names of formats may change; these keys are not compared.
FREE = re.compile(r"(^|/)(format|program|message|why|time_base_why|explanation)$")


def commands(out):
    """Name of the document and the command line that prints it."""
    logs = sorted(LOGS.glob("*.mcap"))
    for log in logs:
        yield f"report-{log.stem}", ["report", log, "--json", "--all", "--max-transition-peak-deg", "0.5", "--max-lag-ms", "50"]
        yield f"info-{log.stem}", ["info", log, "--json"]
        yield f"report-{log.stem}.csv", ["report", log, "--csv"]
    runs = [LOGS / "task-1-run.mcap", LOGS / "task-2-run.mcap"]
    yield "fit-task-1", ["fit", runs[0], LOGS / "identification-run.mcap", "--json", "-o", out / "limits.toml"]
    yield "fit-pressures", ["fit", LOGS / "pressures-run.mcap", "--json"]
    yield "replan-1", ["replan", runs[0], "--json", "-o", out / "next.mcap"]
    yield "replan-2", ["replan", runs[1], "--keep-plan", "--gain", "0.5", "--json", "-o", out / "next-2.mcap"]
    yield "replan-limits", ["replan", runs[0], "--limits", out / "limits.toml", "--keep-plan", "--json", "-o", out / "next-3.mcap"]
    yield "compare-1", ["compare", runs[0], LOGS / "precompensated-run.mcap", "--json"]
    yield "compare-2", ["compare", runs[0], runs[1], "--json"]
    yield "plan-1", ["plan", LOGS / "tasks/task-1.toml", "--json", "-o", out / "plan.mcap"]
    yield "plan-2", ["plan", LOGS / "tasks/task-2.toml", "--choose", "knee", "--json"]
    yield "plan-times", ["plan", LOGS / "tasks/task-1.toml", "--times", "0,5.31,11.47,16.36,26.27,38.72", "--json"]
    yield "import", ["import", LOGS / "plc-trace.csv", "-o", out / "plc.mcap", "--json"]
    yield "simulate.csv", ["simulate", out / "next.mcap", "-o", out / "run-2.mcap"]
    yield "report-run-2", ["report", out / "run-2.mcap", "--json", "--all"]
    yield "recover", ["recover", LOGS / "power-loss.mcap", "-o", out / "whole.mcap", "--json"]
    yield "export.csv", ["export", runs[0], "-o", out / "export-1.csv"]


def write(binary, out):
    out.mkdir(parents=True, exist_ok=True)
    for name, words in commands(out):
        run = subprocess.run([binary, *map(str, words)], capture_output=True, text=True)
        if run.returncode in (1, 2):
            print(f"{name}: exit {run.returncode}: {run.stderr.strip()[:300]}")
        (out / (name if name.endswith(".csv") else name + ".json")).write_text(run.stdout)


def flat(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from flat(inner, f"{path}/{key}")
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from flat(inner, f"{path}/{place}")
    else:
        yield path, value


def old_name(path):
    parts = [RENAMED.get(part, part) for part in path.split("/")]
    # The objectives of a plan were a list.
    if len(parts) > 2 and parts[-2] in ("objectives_before", "objectives_after") and parts[-1] in OBJECTIVES:
        parts[-1] = str(OBJECTIVES.index(parts[-1]))
    return "/".join(parts)


def bare(path):
    """A key without its unit."""
    return re.sub(r"_rad(_s[23]?)?(?=/|$)", "", path)


def columns(path):
    """Cells of a table by the key of their column, without its unit."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    head, *rows = csv.reader(lines)
    return {bare(key): [row[k] for row in rows] for k, key in enumerate(head)}


def spelt(value):
    """Names of metrics are keys now: peak_error for peak-error, onset_delay_s for onset-delay."""
    return value.replace("_", "-").removesuffix("-s") if isinstance(value, str) else value


def compare(old, new):
    wrong = 0
    for file in sorted(old.glob("*.json")):
        before = dict(flat(json.loads(file.read_text() or "null")))
        after = dict(flat(json.loads((new / file.name).read_text() or "null")))
        after = {old_name(path): value for path, value in after.items()}
        by_bare = {bare(path): path for path in before}
        used, added, changed = set(), [], []
        for path, value in after.items():
            origin = path if path in before else by_bare.get(bare(path))
            if origin is None:
                added.append(path)
                continue
            used.add(origin)
            if spelt(before[origin]) != spelt(value) and not FREE.search(path):
                changed.append(f"{path}: {before[origin]!r} -> {value!r}")
        lost = [path for path in before if path not in used and not FREE.search(path)]
        pattern = lambda paths: sorted({re.sub(r"/\d+", "/*", path) for path in paths})
        if changed or lost or added:
            print(f"== {file.name}: {len(before)} values, {len(changed)} changed, {len(lost)} lost, {len(added)} added")
        for line in changed[:20]:
            print("  changed", line)
        for line in pattern(lost)[:40]:
            print("  lost", line)
        for line in pattern(added)[:60]:
            print("  added", line)
        wrong += len(changed) + len(lost)
    for file in sorted(old.glob("report-*.csv")):
        if not (new / file.name).exists():
            continue
        found = [columns(folder / file.name) for folder in (old, new)]
        other = [key for key, cells in found[0].items() if key not in ("answer", "run") and found[1].get(key) != cells]
        if other:
            print(f"== {file.name}: other {other}")
            wrong += len(other)
    return 1 if wrong else 0


if __name__ == "__main__":
    os.chdir(pathlib.Path(__file__).resolve().parents[2])
    verb, first, second = sys.argv[1:]
    sys.exit(compare(pathlib.Path(first), pathlib.Path(second)) if verb == "compare" else write(first, pathlib.Path(second)))
