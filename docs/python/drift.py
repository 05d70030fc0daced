"""Which machine drifts: from a folder of logs to a picture.

    python drift.py LOGS [DATASET]

A notebook as a plain script: each `# %%` begins a cell in editors that know them. Needs hydrotrace-logs, matplotlib and
polars.
"""

# %% The dataset: only logs that are new are analysed.
import sys

import matplotlib.pyplot as plt
import polars

import hydrotrace_logs as ht

logs, dataset = (sys.argv[1:] + ["fleet"])[:2]
done = ht.scan(logs, dataset)
print(f"{done.document['logs']} logs, {done.document['analysed']} analysed now, {len(done)} could not be read")

# %% Which joints drift, by dead time.
drift = polars.DataFrame(ht.drift(dataset, by="delay"))
print(drift.select("machine", "joint", "slope_per_day", "slope_low", "slope_high", "q_value", "found"))

# %% The dead time of each start over the days, a line a joint: the median of each run.
runs = polars.read_parquet(f"{dataset}/runs/**/*.parquet").select("run_id", "started_at")
starts = polars.read_parquet(f"{dataset}/transitions/**/*.parquet").join(runs, on="run_id")
daily = (
    starts.group_by("machine", "joint", "started_at")
    .agg(polars.col("onset_delay_s").median())
    .drop_nulls()
    .sort("started_at")
)

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
found = {(row["machine"], row["joint"]) for row in drift.filter("found").iter_rows(named=True)}
for (machine, joint), line in daily.group_by("machine", "joint", maintain_order=True):
    is_found = (machine, joint) in found
    style = {"linewidth": 2.0, "label": f"{machine} {joint}"} if is_found else {"color": "0.7", "linewidth": 0.8}
    left.plot(line["started_at"], 1000 * line["onset_delay_s"], **style)
left.set_ylabel("dead time, ms")
left.tick_params(axis="x", rotation=30)
if found:
    left.legend(title="drift found")

# %% Slopes with their 95 % intervals.
drift = drift.sort("slope_per_day")
slopes = 1000 * drift["slope_per_day"]
below, above = slopes - 1000 * drift["slope_low"], 1000 * drift["slope_high"] - slopes
names = [f"{machine} {joint}" for machine, joint in zip(drift["machine"], drift["joint"])]
right.errorbar(slopes, names, xerr=[below, above], fmt="o")
right.axvline(0.0, color="0.7", zorder=0)
right.set_xlabel("growth of the dead time, ms a day")

# %% The picture.
figure.savefig("drift.png", dpi=120)
print("drift.png")
