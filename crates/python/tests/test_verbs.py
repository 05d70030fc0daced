"""The other verbs, each on a sample log."""

import polars
import pytest

import hydrotrace_logs as ht
from conftest import SAMPLES, write_run


def test_what_is_written_is_read_back(tmp_path):
    path = tmp_path / "run.mcap"
    write_run(path, "M7", 0, 0.2)
    found = ht.report(path)
    assert found.machine == "M7"
    delays = polars.DataFrame(found.transitions).group_by("joint").agg(polars.col("onset_delay_s").median())
    delays = dict(delays.iter_rows())
    assert delays["boom"] == pytest.approx(0.2, abs=0.03) and delays["stick"] == pytest.approx(0.1, abs=0.03)
    with pytest.raises(ht.WriteError, match="run.mcap"):
        ht.LogWriter(path, ["boom"])
    with pytest.raises(ht.WriteError, match="twice"):
        ht.LogWriter(tmp_path / "other.mcap", ["boom", "boom"])
    log = ht.LogWriter(tmp_path / "other.mcap", ["boom"])
    with pytest.raises(ht.WriteError, match="position"):
        log.joint_sample("measured", 0, [1.0, 2.0])
    log.interfaces(0, {"valve_command": [0.5]})
    log.close()
    log.close()
    with pytest.raises(ht.WriteError, match="the log is closed"):
        log.flush()


def test_compare_has_a_row_for_each_pair():
    before, after = SAMPLES / "task-1-run.mcap", SAMPLES / "precompensated-run.mcap"
    found = ht.compare(before, [after])
    table = polars.DataFrame(found)
    assert len(table) == len(found.document["pairs"]) > 5
    assert table["peak_error_after"].mean() < table["peak_error_before"].mean()
    assert ht.compare(before.read_bytes(), after).table.to_dicts() == found.table.to_dicts()


def test_fit_replan_and_report_make_a_loop(tmp_path):
    run = SAMPLES / "task-1-run.mcap"
    machine = ht.fit(run)
    lags = polars.DataFrame(machine).filter(quantity="lag_s")
    assert len(lags) == 6 and lags["value"].is_between(0.01, 1.0).all()
    (tmp_path / "limits.toml").write_text(machine.toml)
    next_run = ht.replan(run, limits=tmp_path / "limits.toml", keep_plan=True, gain=0.5)
    assert next_run.mcap.startswith(b"\x89MCAP0\r\n")
    assert polars.DataFrame(next_run)["expected_peak_rad"].max() < 1.0
    sent = polars.DataFrame(ht.read(data=next_run.mcap, name="next.mcap"))
    assert {"planned", "command"} <= set(sent["signal"].unique())


def test_a_plan_is_a_front_and_a_log():
    task = SAMPLES / "tasks" / "task-1.toml"
    found = ht.plan(task, evaluations=500)
    assert found.document["feasible"] and found.mcap.startswith(b"\x89MCAP0\r\n")
    front = polars.DataFrame(found)
    assert front["duration_s"].is_sorted() and "arrival_2_s" in front.columns
    again = ht.plan(task, evaluations=500, threads=1)
    assert again.mcap == found.mcap
    given = ht.plan(task, times_s=found.document["chosen"]["times_s"])
    assert len(given) == 1
    for rate_hz in [-1.0, 0.0, float("inf"), float("nan")]:
        with pytest.raises(ht.WriteError, match="a rate from 1 to 10000 Hz is expected"):
            ht.plan(task, times_s=found.document["chosen"]["times_s"], rate_hz=rate_hz)
    with pytest.raises(ht.PlanError, match="time_growth is -5"):
        ht.replan(SAMPLES / "task-1-run.mcap", evaluations=1000, max_time_growth=-5.0)
    with pytest.raises(ht.PlanError, match="cannot read .*nothing.toml"):
        ht.plan("nothing.toml")
    with pytest.raises(ht.FitError, match="No such file"):
        ht.fit("nothing.mcap")
