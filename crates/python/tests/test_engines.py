"""Ray, Dask and Spark on this machine: two workers, one killed in mid job, every log exactly once in the result.

An engine that is not installed is skipped: `pip install ray "dask[dataframe,distributed]" pyspark`.
"""

import os
import pathlib
import signal
import sys
import threading
import time

import polars
import pytest

import hydrotrace_logs as ht

COPIES = 20


@pytest.fixture(scope="module")
def many(fleet_logs, tmp_path_factory):
    """Enough logs that a worker can be killed while it has some."""
    folder = tmp_path_factory.mktemp("many")
    paths = []
    for copy in range(COPIES):
        for log in sorted(fleet_logs.glob("M[01]/*.mcap")):
            path = folder / f"{copy:02}" / log.parent.name / log.name
            path.parent.mkdir(parents=True, exist_ok=True)
            os.link(log, path)
            paths.append(str(path))
    (folder / "broken.mcap").write_bytes(b"no log")
    return [*paths, str(folder / "broken.mcap")]


class Trace:
    """Rows of a batch. The process that makes them leaves its number and a line for each batch in a folder."""

    def __init__(self, folder):
        self.folder = str(folder)

    def __call__(self, batch):
        with open(pathlib.Path(self.folder) / f"{os.getpid()}", "a") as file:
            file.write("batch\n")
        return ht.transitions_of(batch)


def kill_one(folder, killed):
    """Kills a worker that has begun two batches, once two are at work."""
    until = time.monotonic() + 300
    while time.monotonic() < until:
        done = {int(path.name): len(path.read_text().split()) for path in folder.iterdir()}
        if len(done) >= 2 and max(done.values()) >= 2:
            pid = max(done, key=done.get)
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)
            return
        time.sleep(0.01)


def check(name, rows, many, seconds, killed):
    assert killed, f"{name}: no worker was killed"
    counts = rows.group_by("log_uri").len()
    assert sorted(counts["log_uri"]) == sorted(many)
    expected = len(ht.report(many[0]).transitions)
    assert sorted(counts["len"]) == [1] + [expected] * (len(many) - 1)
    assert rows["error"].drop_nulls().len() == 1
    print(f"{name}: {len(many)} logs, {len(rows)} rows, {seconds:.1f} s, workers killed: {len(killed)}")


@pytest.fixture
def killing(tmp_path):
    folder, killed = tmp_path / "trace", []
    folder.mkdir()
    thread = threading.Thread(target=kill_one, args=(folder, killed), daemon=True)
    thread.start()
    return folder, killed


def test_ray(many, killing, tmp_path, monkeypatch):
    # A busy machine starts slowly; workers import this file.
    monkeypatch.setenv("RAY_raylet_start_wait_time_s", "300")
    monkeypatch.setenv("PYTHONPATH", str(pathlib.Path(__file__).parent))
    ray = pytest.importorskip("ray")
    pytest.importorskip("ray.data")
    folder, killed = killing
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    trace = Trace(folder)
    try:
        began = time.monotonic()
        found = ray.data.from_items(many, override_num_blocks=20).map_batches(lambda batch: trace(batch), batch_size=16)
        found.write_parquet(str(tmp_path / "rows"))
        seconds = time.monotonic() - began
    finally:
        ray.shutdown()
    check("Ray", polars.read_parquet(tmp_path / "rows"), many, seconds, killed)


def test_dask(many, killing):
    distributed = pytest.importorskip("dask.distributed")
    dataframe = pytest.importorskip("dask.dataframe")
    import dask
    import pandas
    import pyarrow

    folder, killed = killing
    settings = {"distributed.scheduler.allowed-failures": 10, "dataframe.convert-string": False}
    with dask.config.set(settings):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster):
                began = time.monotonic()
                logs = dataframe.from_pandas(pandas.DataFrame({"path": many}), npartitions=20)
                meta = pyarrow.table(ht.transitions_of([])).to_pandas()
                found = logs.map_partitions(Trace(folder), meta=meta).compute()
                seconds = time.monotonic() - began
    check("Dask", polars.from_pandas(found), many, seconds, killed)


def test_spark(many, monkeypatch):
    pytest.importorskip("pyspark")
    # Its workers start a python3 of their own choice otherwise.
    monkeypatch.setenv("PYSPARK_PYTHON", sys.executable)
    import pyarrow
    from pyspark.sql import SparkSession
    from pyspark.sql.pandas.types import from_arrow_schema

    builder = SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false")
    try:
        session = builder.config("spark.driver.host", "127.0.0.1").getOrCreate()
    except Exception as error:  # no Java, or one that it does not take
        pytest.skip(f"Spark does not start here: {error}")
    try:
        schema = from_arrow_schema(pyarrow.table(ht.transitions_of([])).schema)
        logs = session.createDataFrame([(path,) for path in many], "path string").repartition(8)
        began = time.monotonic()
        rows = logs.mapInArrow(ht.transitions_of, schema).toArrow()
        seconds = time.monotonic() - began
    finally:
        session.stop()
    check("Spark, local mode", polars.from_arrow(rows), many, seconds, ["its workers are threads of one process"])
