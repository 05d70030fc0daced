"""The dataset and its answers, and rows for engines."""

import datetime
import os
import signal
import subprocess
import sys
import time

import pandas
import polars
import pyarrow
import pytest

import hydrotrace_logs as ht


@pytest.fixture(scope="module")
def dataset(fleet_logs, tmp_path_factory):
    into = tmp_path_factory.mktemp("data") / "fleet"
    seen = []
    done = ht.scan(sorted(fleet_logs.glob("M*")), into, workers=2, progress=lambda *now: seen.append(now))
    assert done.document["analysed"] == 32 and len(done) == 0
    assert sorted(now[0] for now in seen) == list(range(1, 33)) and {now[1:] for now in seen} == {(32, 0)}
    return into


def test_a_second_scan_has_nothing_to_do(dataset, fleet_logs):
    assert ht.scan([fleet_logs / f"M{k}" for k in range(4)], dataset).document["analysed"] == 0


def test_the_drift_is_found_and_nothing_else(dataset):
    found = ht.drift(dataset)
    rows = [row for row in found.table.to_dicts() if row["found"] and row["metric"] == "delay"]
    assert [(row["machine"], row["joint"]) for row in rows] == [("M0", "boom")]
    assert rows[0]["slope_per_day"] == pytest.approx(0.02, rel=0.1)
    assert found.document["runs"] == 32
    late = ht.drift(dataset, by="delay", machine="M0", since=datetime.date(2026, 1, 3))
    assert late.document["runs"] == 6
    worst = ht.worst(dataset, by="delay")
    assert worst.table["machine"][0] == "M0"
    effect = ht.effect(dataset, machine="M0", at="2026-01-05", by="delay")
    # What goes on before as after is no effect of that day.
    assert polars.DataFrame(effect).filter(joint="boom")["change"][0] == pytest.approx(0, abs=0.01)
    boom = next(one for one in effect.document["effects"] if one["joint"] == "boom")
    assert boom["drift_per_day"] == pytest.approx(0.02, rel=0.1) and not boom["found"]
    with pytest.raises(ht.FleetError, match='no machine "M9"'):
        ht.drift(dataset, machine="M9")
    with pytest.raises(ValueError, match="neither a day"):
        ht.drift(dataset, since="yesterday")


def test_rows_of_a_report_are_those_of_the_dataset(dataset, fleet_logs):
    log = fleet_logs / "M1" / "2026-01-02.mcap"
    found = ht.report(log)
    for name, table in [("transitions", found.transitions), ("joints", found.joints), ("runs", found.run)]:
        stored = polars.read_parquet(f"{dataset}/{name}/**/*.parquet", hive_partitioning=False)
        stored = stored.filter(run_id=found.run_id)
        assert stored.columns == table.columns
        assert stored.sort(table.columns[:6]).equals(polars.DataFrame(table).sort(table.columns[:6]))


def test_batches_keep_every_log(logs):
    expected = polars.DataFrame(ht.transitions_of(logs))
    assert sorted(expected["log_uri"].unique()) == sorted(logs)
    broken = expected.filter(polars.col("error").is_not_null())
    assert broken["log_uri"].to_list() == [logs[-2]] and "is not an MCAP file" in broken["error"][0]
    forms = [
        ht.transitions_of({"item": logs}),
        ht.transitions_of(pyarrow.table({"path": logs})),
        ht.transitions_of(pyarrow.record_batch({"uri": logs})),
        ht.transitions_of(pandas.DataFrame({"log": logs, "other": 1})),
        ht.transitions_of(pandas.Series(logs)),
        next(ht.transitions_of(iter([pyarrow.record_batch({"run": logs})]), column="run")),
    ]
    assert [type(form).__name__ for form in forms] == ["Table", "Table", "RecordBatch", "DataFrame", "DataFrame", "RecordBatch"]
    for form in forms:
        table = pyarrow.Table.from_pandas(form) if isinstance(form, pandas.DataFrame) else form
        assert polars.DataFrame(pyarrow.table(table))["peak_error"].equals(expected["peak_error"])
    data = [open(log, "rb").read() for log in logs]
    of_bytes = polars.DataFrame(ht.transitions_of({"bytes": data, "path": logs}))
    assert of_bytes["peak_error"].equals(expected["peak_error"])
    assert sorted(polars.DataFrame(ht.runs_of(logs))["log_uri"]) == sorted(logs)
    empty = ht.transitions_of(pyarrow.record_batch({"path": pyarrow.array([], pyarrow.string())}))
    assert type(empty).__name__ == "RecordBatch" and empty.num_rows == 0 and "error" in empty.schema.names
    assert len(ht.joints_of([])) == 0 and "error" in ht.joints_of([]).columns
    with pytest.raises(ValueError, match="no column of logs among a, b"):
        ht.transitions_of({"a": [], "b": []})


def test_a_forked_child_does_all_that_its_parent_did(run, dataset):
    def all_of_it():
        ht.report(run)
        ht.fit(run, threads=2)
        ht.plan(run.parent / "tasks" / "task-1.toml", evaluations=500)
        ht.drift(dataset)

    all_of_it()
    child = os.fork()
    if child == 0:
        all_of_it()
        os._exit(0)
    for _ in range(600):
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            assert status == 0
            return
        time.sleep(0.1)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    pytest.fail("the child hangs")


def interrupted(text):
    """Runs some Python, interrupts it after a second of work, and gives its output."""
    program = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
    assert program.stdout.readline() == "ready\n"
    time.sleep(1.0)
    began = time.monotonic()
    program.send_signal(signal.SIGINT)
    out, _ = program.communicate(timeout=60)
    return out, time.monotonic() - began


CAUGHT = """
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_an_interrupted_plan_ends_soon(run):
    task = run.parent / "tasks" / "task-1.toml"
    work = CAUGHT.format(work=f"ht.plan({str(task)!r}, evaluations=3_000_000)")
    out, seconds = interrupted("import hydrotrace_logs as ht\nprint('ready', flush=True)" + work)
    assert out == "interrupted\n" and seconds < 35.0, seconds


def test_an_interrupted_scan_keeps_what_it_has(fleet_logs, tmp_path):
    source = tmp_path / "logs.txt"
    copies = []
    for copy in range(40):
        for log in sorted((fleet_logs / "M1").glob("*.mcap")):
            to = tmp_path / "copies" / f"{copy}" / log.name
            to.parent.mkdir(parents=True, exist_ok=True)
            os.link(log, to)
            copies.append(str(to))
    source.write_text("\n".join(copies))
    into = tmp_path / "data"
    work = CAUGHT.format(work=f"ht.scan({str(source)!r}, {str(into)!r}, workers=1)")
    out, seconds = interrupted("import hydrotrace_logs as ht\nprint('ready', flush=True)" + work)
    assert out == "interrupted\n" and seconds < 10.0, seconds
    kept = len(polars.read_parquet(f"{into}/runs/**/*.parquet"))
    assert 0 < kept < len(copies)
    rest = ht.scan(source, into).document
    assert (rest["unchanged"], rest["analysed"]) == (kept, len(copies) - kept)
