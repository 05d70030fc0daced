"""What the tests share: the sample logs, and a fleet of simulated logs."""

import pathlib

import pytest

import hydrotrace_logs as ht

ROOT = pathlib.Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "sample-logs"


@pytest.fixture
def run():
    return SAMPLES / "task-1-run.mcap"


def write_run(path, machine, day, dead_time_s):
    """A minute of two joints that follow their plan late; every start of the boom by ``dead_time_s``."""
    start_ns = (1_767_225_600 + day * 86_400) * 1_000_000_000
    path.parent.mkdir(parents=True, exist_ok=True)
    late = [dead_time_s, 0.1]

    def angle(joint, t_s):
        # A smooth move of 2 s every 8 s, up and down in turn.
        number, within = divmod(t_s - 2.0, 8.0)
        share = min(max(within / 2.0, 0.0), 1.0) if t_s >= 2.0 else 0.0
        smooth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        up = number < 0 or int(number) % 2 == 0
        return (0.3 + 0.1 * joint) * (smooth if up else 1.0 - smooth)

    with ht.LogWriter(path, ["boom", "stick"]) as log:
        log.metadata("run", {"machine": machine})
        for k in range(3000):
            t_s = 0.02 * k
            noise = 1e-5 * ((k * 7919 + day * 104729) % 101 - 50) / 50
            stamp_ns = start_ns + k * 20_000_000
            log.joint_sample("planned", stamp_ns, [angle(j, t_s) for j in range(2)])
            came = [angle(j, t_s - late[j]) + noise for j in range(2)]
            log.joint_sample("measured", stamp_ns, came)


@pytest.fixture(scope="session")
def fleet_logs(tmp_path_factory):
    """Four machines over eight days; the dead time of M0's boom grows by 20 ms a day."""
    folder = tmp_path_factory.mktemp("logs")
    for machine in range(4):
        for day in range(8):
            dead_time_s = 0.15 + (0.02 * day if machine == 0 else 0.0)
            write_run(folder / f"M{machine}" / f"2026-01-{day + 1:02}.mcap", f"M{machine}", day, dead_time_s)
    return folder


@pytest.fixture(scope="session")
def logs(fleet_logs):
    """Twelve logs, one of them broken, one without a start."""
    paths = sorted(fleet_logs.glob("M[01]/*.mcap"))[:10]
    broken = fleet_logs / "broken.log"
    broken.write_bytes(b"this is no log")
    return [*map(str, paths), str(broken), str(SAMPLES / "still-joint.mcap")]
