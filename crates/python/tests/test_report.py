"""report: inputs, tables, errors."""

import io
import pickle
import subprocess
import sys

import pandas
import polars
import pyarrow
import pytest

import hydrotrace_logs as ht


def test_a_report_is_four_tables(run):
    found = ht.report(run)
    table = pyarrow.table(found.transitions)
    assert table.num_rows == len(found.transitions) > 5
    assert {"run_id", "joint", "event_index", "planned_onset_s", "onset_delay_s", "peak_error"} <= set(table.column_names)
    assert set(found.joints["joint"]) == set(found.transitions["joint"])
    [one] = found.run.to_dicts()
    assert one["run_id"] == found.run_id and one["plan_id"] == found.plan_id and one["error"] is None
    assert one["transitions"] == table.num_rows and one["log_uri"] == str(run)
    assert found.document["format"].startswith("hydrotrace.report.")
    assert str(pyarrow.table(found.run).schema.field("started_at").type) == "timestamp[us, tz=UTC]"
    assert repr(found).startswith("<Report of task-1-run.mcap: ")


def test_paths_bytes_and_file_objects_give_the_same(run):
    data = run.read_bytes()
    expected = ht.report(run).transitions.to_dicts()
    with open(run, "rb") as file:
        others = [
            ht.report(str(run)),
            ht.report([run]),
            ht.report(data=data, name="task-1-run.mcap"),
            ht.report(bytearray(data)),
            ht.report(memoryview(data)),
            ht.report(io.BytesIO(data)),
            ht.report(file),
        ]
    for other in others:
        rows = other.transitions.to_dicts()
        assert [{**row, "run_id": ""} for row in rows] == [{**row, "run_id": ""} for row in expected]


def test_tables_share_their_memory(run):
    found = ht.report(run)
    table = found.transitions
    for name in ("peak_error", "onset_delay_s", "event_index"):
        [address] = {pyarrow.table(table)[name].chunk(0).buffers()[1].address for _ in range(3)}
        assert polars.DataFrame(table)[name].to_arrow().buffers()[1].address == address
    # Asking again does not make the table again.
    again = pyarrow.table(found.transitions)["peak_error"].chunk(0).buffers()[1].address
    assert again == pyarrow.table(table)["peak_error"].chunk(0).buffers()[1].address


def test_pandas_polars_and_duckdb_take_tables(run):
    import duckdb

    found = ht.report(run).transitions
    mean = sum(found["peak_error"]) / len(found)
    assert polars.DataFrame(found)["peak_error"].mean() == pytest.approx(mean)
    assert pyarrow.table(found).to_pandas()["peak_error"].mean() == pytest.approx(mean)
    if hasattr(pandas.DataFrame, "from_arrow"):
        assert pandas.DataFrame.from_arrow(found)["peak_error"].mean() == pytest.approx(mean)
    starts = pyarrow.table(found)  # noqa: F841
    assert duckdb.execute("SELECT avg(peak_error) FROM starts").fetchone()[0] == pytest.approx(mean)


def test_errors_say_what_the_command_line_says(run, tmp_path):
    with pytest.raises(ht.LogError, match=r"cannot open nothing\.mcap: No such file or directory") as caught:
        ht.report("nothing.mcap")
    assert isinstance(caught.value, ht.HydrotraceError) and isinstance(caught.value.__cause__, FileNotFoundError)
    with pytest.raises(ht.LogError, match="is not an MCAP file: found 6E 6F"):
        ht.report(data=b"no log", name="x.mcap")
    with pytest.raises(ht.LogError, match='no topic "/plan/joint_states", did you mean'):
        ht.report(run.parent / "panel-install.mcap", planned="/plan/joint_states")
    with pytest.raises(TypeError, match='no option "plan"; there are planned, measured'):
        ht.report(run, plan="/x")
    with pytest.raises(TypeError, match="either a log or data="):
        ht.report()
    with pytest.raises(KeyError, match="no column"):
        ht.report(run).joints["angle"]


def test_a_file_object_that_fails_is_an_error_with_its_words():
    class Broken(io.BytesIO):
        def read(self, size=-1):
            raise RuntimeError("the store is away")

    with pytest.raises(ht.LogError, match="the store is away"):
        ht.report(Broken(b"1234567890" * 10))


def test_options_of_reading_are_those_of_the_command_line(run):
    late = ht.report(run, measured_delay_ms=50.0, from_s=2.0, to_s=20.0)
    lags = [ht.report(run, from_s=2.0, to_s=20.0), late]
    shift = [polars.DataFrame(found.joints)["lag_s"].median() for found in lags]
    assert shift[0] - shift[1] == pytest.approx(0.05, abs=0.01)
    for options in [{"measured_delay_ms": 1e9}, {"from_s": float("nan")}, {"joints_as": "cylinders"}]:
        with pytest.raises(ValueError):
            ht.report(run, **options)


def test_a_report_goes_from_process_to_process(run):
    found = ht.report(run)
    again = pickle.loads(pickle.dumps(found))
    assert again.transitions.to_dicts() == found.transitions.to_dicts()
    assert again.run.to_dicts() == found.run.to_dicts()


def test_samples_are_a_table(run):
    samples = polars.DataFrame(ht.read(run))
    assert samples.columns == ["signal", "joint", "unit", "segment", "t_s", "position", "velocity"]
    assert {"planned", "measured"} <= set(samples["signal"].unique())
    assert samples["unit"].unique().to_list() == ["rad"]
    one = samples.filter(signal="measured", joint=samples["joint"][0])
    assert one["t_s"].is_sorted() and len(one) > 1000
    assert ht.read(run).document["source"]["measured_topic"] == "/joint_states"


def test_a_recorder_that_says_nothing_costs_no_import():
    text = "import time; t = time.perf_counter(); import hydrotrace_logs; print(time.perf_counter() - t)"
    seconds = min(float(subprocess.check_output([sys.executable, "-c", text])) for _ in range(5))
    print(f"import: {1000 * seconds:.1f} ms")
    assert seconds < 0.05
