"""The guide's page and the notebook say what is so: their Python runs, and prints what is shown.

UPDATE_DOCS=1 writes what is printed into the page.
"""

import json
import os
import pathlib
import re
import runpy
import shutil
import sys
from datetime import datetime

import pytest

from conftest import ROOT, SAMPLES, write_run

PAGE = ROOT / "docs" / "guide" / "python.md"
BLOCK = re.compile(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```\n)?", re.DOTALL)
# Blocks of engines run in test_engines.py.
ENGINE = re.compile(r"import (ray|dask|pyspark)\b|from (ray|dask|pyspark)\b")


@pytest.fixture
def here(tmp_path, monkeypatch):
    shutil.copytree(SAMPLES, tmp_path / "sample-logs")
    for machine in range(2):
        for day in range(6):
            dead_time_s = 0.15 + (0.02 * day if machine == 0 else 0.0)
            path = tmp_path / "logs" / f"M{machine}" / f"2026-01-{day + 1:02}.mcap"
            write_run(path, f"M{machine}", day, dead_time_s)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_page_runs_and_prints_what_it_shows(here, capsys):
    names = {}
    page = PAGE.read_text()
    blocks = BLOCK.findall(page)
    assert len(blocks) > 5
    for code, shown in blocks:
        is_shown = f"{code}```\n\n```text\n" in page
        program = compile(code, str(PAGE), "exec")
        if ENGINE.search(code):
            continue
        capsys.readouterr()
        exec(program, names)
        printed = capsys.readouterr().out
        if os.environ.get("UPDATE_DOCS"):
            page = page.replace(f"{code}```\n\n```text\n{shown}```", f"{code}```\n\n```text\n{printed}```")
        elif is_shown:
            expected = re.escape(shown).replace(r"\.\.\.", "(?:.|\n)*?")
            assert re.fullmatch(expected, printed), f"{code}\nprinted:\n{printed}\nshown:\n{shown}"
    if os.environ.get("UPDATE_DOCS"):
        PAGE.write_text(page)


def test_the_notebook_runs_and_draws(here, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setattr(sys, "argv", ["drift.py", "logs"])
    runpy.run_path(str(ROOT / "docs" / "python" / "drift.py"), run_name="__main__")
    assert pathlib.Path("drift.png").stat().st_size > 10_000
    assert os.path.isdir("fleet")


def test_starts_become_events_of_foxglove(here, monkeypatch, capsys):
    import hydrotrace_logs as ht

    ht.scan("logs", "fleet")
    capsys.readouterr()
    monkeypatch.setattr(sys, "argv", ["foxglove_events.py", "fleet", "0.5"])
    runpy.run_path(str(ROOT / "docs" / "python" / "foxglove_events.py"), run_name="__main__")
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert events and {event["deviceName"] for event in events} == {"M0", "M1"}
    for event in events:
        begins, ends = (datetime.fromisoformat(event[key]) for key in ("start", "end"))
        assert begins.tzinfo and begins <= ends and begins.year >= 2026
        assert all(isinstance(value, str) for value in event["metadata"].values())
        assert float(event["metadata"]["peak_error_deg"]) >= 0.5
    assert len({event["metadata"]["event_id"] for event in events}) == len(events)
