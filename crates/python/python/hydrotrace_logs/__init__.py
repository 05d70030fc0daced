"""Where and by how much a hydraulic arm leaves its plan, from its logs.

Times are seconds, angles radians, lengths metres; other units are in the names of columns. Tables are Arrow: hand them
to ``polars.DataFrame``, ``pyarrow.table`` or DuckDB.
"""

from ._batches import joints_of, runs_of, transitions_of
from ._core import (
    __VERSION__ as __version__,
    Answer,
    Fit,
    FitError,
    FleetError,
    HydrotraceError,
    LogError,
    LogWriter,
    Plan,
    PlanError,
    Report,
    Table,
    WriteError,
    compare,
    drift,
    effect,
    fit,
    plan,
    read,
    replan,
    report,
    scan,
    worst,
)

__all__ = [
    "Answer",
    "Fit",
    "FitError",
    "FleetError",
    "HydrotraceError",
    "LogError",
    "LogWriter",
    "Plan",
    "PlanError",
    "Report",
    "Table",
    "WriteError",
    "compare",
    "drift",
    "effect",
    "fit",
    "joints_of",
    "plan",
    "read",
    "replan",
    "report",
    "runs_of",
    "scan",
    "transitions_of",
    "worst",
]
