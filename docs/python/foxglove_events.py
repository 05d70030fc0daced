"""The largest errors of a fleet as events of Foxglove, a JSON line each: the body of `POST /v1/events`.

    python foxglove_events.py DATASET [PEAK_DEG] > events.jsonl

An event is a start whose peak error is PEAK_DEG (default 1) or more, from when the plan starts until the joint has
settled. Its device is the machine by name. Needs polars, no network and no key; to send them:

    while read -r event; do
      curl --fail --header "Authorization: Bearer $FOXGLOVE_KEY" --json "$event" https://api.foxglove.dev/v1/events
    done < events.jsonl

Foxglove takes an event that is sent twice for two: `metadata.event_id` tells which are the same.
"""

import json
import math
import sys
from datetime import timedelta, timezone

import polars

dataset = sys.argv[1]
least_rad = math.radians(float(sys.argv[2]) if len(sys.argv) > 2 else 1.0)

runs = polars.read_parquet(f"{dataset}/runs/**/*.parquet").select("run_id", "started_at", "log_uri")
starts = polars.read_parquet(f"{dataset}/transitions/**/*.parquet").join(runs, on="run_id")
starts = starts.filter(
    (polars.col("unit") == "rad") & (polars.col("peak_error") >= least_rad) & polars.col("machine").is_not_null()
)

for start in starts.sort("machine", "started_at", "planned_onset_s", "joint").iter_rows(named=True):
    run_begins = start["started_at"].replace(tzinfo=timezone.utc)
    lasts_s = start["settling_time_s"] or start["time_to_peak_s"]
    begins = run_begins + timedelta(seconds=start["planned_onset_s"])
    event = {
        "deviceName": start["machine"],
        "start": begins.isoformat(),
        "end": (begins + timedelta(seconds=lasts_s)).isoformat(),
        "metadata": {
            "joint": start["joint"],
            "peak_error_deg": f"{math.degrees(start['peak_error']):.3f}",
            "delay_ms": "" if start["onset_delay_s"] is None else f"{1000 * start['onset_delay_s']:.0f}",
            "log": start["log_uri"],
            "event_id": f"{start['run_id']}/{start['event_id']}",
        },
    }
    print(json.dumps(event))
