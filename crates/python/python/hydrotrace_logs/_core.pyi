"""Types of the compiled part. Times are s, positions rad or m; other units are in names."""

import datetime
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import TracebackType
from typing import Any, Literal, Protocol, Union, final

from typing_extensions import Self, TypedDict, Unpack

class _File(Protocol):
    def read(self, size: int = ..., /) -> bytes: ...
    def seek(self, offset: int, whence: int = ..., /) -> int: ...

_Path = Union[str, "os.PathLike[str]"]
_Log = Union[_Path, bytes, bytearray, memoryview, _File]
_Logs = Union[_Log, Sequence[_Log]]
_Instant = Union[str, datetime.date, datetime.datetime]
_Metric = Literal["peak", "delay", "lag"]
_Texts = Union[str, Sequence[str]]

class _ReadOptions(TypedDict, total=False):
    """Which topics, joints and clock to read; what is not given is found."""

    planned: _Texts
    """Topics of the plan, "TOPIC" or "TOPIC:FIELD"."""
    measured: _Texts
    """Topics of the measurement."""
    command: str
    """Topic of the command, where it is not the plan (fit, replan, read)."""
    valve: str
    """Topic of the signals to the valves, shares of the full signal (fit, replan)."""
    joints: _Texts
    """Joints to use, in this order; names where the topic has none."""
    time: Literal["header", "publish", "log"]
    """The clock."""
    slides: _Texts
    """Joints that slide: positions in m."""
    measured_delay_ms: float
    """How late the measured stamps are."""
    from_s: float
    """Read from here on, seconds since the start of the log."""
    to_s: float
    """Read up to here."""
    hydraulics: _Path
    """File of the arm's cylinders: lengths in the log become angles."""
    joints_as: Literal["angles", "cylinders"]
    """What joints with a cylinder are read as."""
    continuous: _Texts
    """Joints without end stops, whose angles wrap."""
    planned_degrees: bool
    """The plan is in degrees."""
    measured_degrees: bool
    """The measurement is in degrees."""

class HydrotraceError(Exception):
    """What hydrotrace could not do, and why."""

class LogError(HydrotraceError): ...
class FitError(HydrotraceError): ...
class PlanError(HydrotraceError): ...
class FleetError(HydrotraceError): ...
class WriteError(HydrotraceError): ...

@final
class Table:
    """Columns with units in their names. Takers of Arrow's PyCapsule interface share its memory."""

    @property
    def columns(self) -> list[str]: ...
    def to_dicts(self) -> list[dict[str, Any]]: ...
    def __getitem__(self, column: str, /) -> list[Any]: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...

@final
class Report:
    """The tracking error of one run."""

    @property
    def transitions(self) -> Table: ...
    @property
    def joints(self) -> Table: ...
    @property
    def run(self) -> Table: ...
    @property
    def remarks(self) -> Table: ...
    @property
    def run_id(self) -> str: ...
    @property
    def plan_id(self) -> str | None: ...
    @property
    def machine(self) -> str | None: ...
    @property
    def document(self) -> dict[str, Any]: ...

class Answer:
    """What a verb found; it is its main table."""

    @property
    def table(self) -> Table: ...
    @property
    def remarks(self) -> Table: ...
    @property
    def json(self) -> str: ...
    @property
    def document(self) -> dict[str, Any]: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...

@final
class Fit(Answer):
    """A fitted machine."""

    @property
    def toml(self) -> str: ...

@final
class Plan(Answer):
    """A plan, and after replan a command for it."""

    @property
    def mcap(self) -> bytes: ...

@final
class LogWriter:
    """Writes samples of one set of joints into an MCAP log, as they come. Stamps are ns since 1970."""

    def __new__(cls, path: _Path, joints: Sequence[str]) -> Self: ...
    def joint_sample(
        self,
        role: Literal["planned", "measured", "command"],
        stamp_ns: int,
        position: Iterable[float],
        velocity: Iterable[float] | None = None,
        effort: Iterable[float] | None = None,
    ) -> None: ...
    def interfaces(self, stamp_ns: int, values: Mapping[str, Iterable[float]]) -> None: ...
    def metadata(self, name: str, entries: Mapping[str, str]) -> None: ...
    def flush(self) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> Self: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

def report(
    log: _Logs | None = None,
    *,
    data: _Log | None = None,
    name: str | None = None,
    machine_from: str = "log",
    urdf: _Path | None = None,
    tool: str | None = None,
    **options: Unpack[_ReadOptions],
) -> Report: ...
def read(
    log: _Logs | None = None,
    *,
    data: _Log | None = None,
    name: str | None = None,
    **options: Unpack[_ReadOptions],
) -> Answer: ...
def compare(before: _Logs, after: _Logs, **options: Unpack[_ReadOptions]) -> Answer: ...
def fit(logs: _Logs, *, threads: int = 0, **options: Unpack[_ReadOptions]) -> Fit: ...
def plan(
    task: _Path,
    *,
    times_s: Sequence[float] | None = None,
    evaluations: int = 20_000,
    seed: int = 1,
    shape: Literal["timing", "free"] = "timing",
    rate_hz: float = 100.0,
    threads: int = 0,
) -> Plan: ...
def replan(
    logs: _Logs,
    *,
    limits: _Path | None = None,
    task: _Path | None = None,
    keep_plan: bool = False,
    precompensate: bool = True,
    retime: bool = False,
    gain: float = 1.0,
    max_correction_rad: float | None = None,
    max_correction_m: float | None = None,
    max_time_growth: float = 0.0,
    max_cost_growth: float = 0.1,
    evaluations: int = 20_000,
    seed: int = 1,
    rate_hz: float = 100.0,
    threads: int = 0,
    **options: Unpack[_ReadOptions],
) -> Plan: ...
def scan(
    sources: _Path | Sequence[_Path],
    into: _Path,
    *,
    machine_from: str = "log",
    workers: int | None = None,
    progress: Callable[[int, int, int], object] | None = None,
    **options: Unpack[_ReadOptions],
) -> Answer: ...
def worst(
    dataset: _Path,
    *,
    by: _Metric = "peak",
    machine: str | None = None,
    joint: str | None = None,
    since: _Instant | None = None,
) -> Answer: ...
def drift(
    dataset: _Path,
    *,
    by: _Metric | None = None,
    machine: str | None = None,
    joint: str | None = None,
    since: _Instant | None = None,
) -> Answer: ...
def effect(
    dataset: _Path,
    *,
    machine: str,
    at: _Instant,
    by: _Metric | None = None,
    joint: str | None = None,
    since: _Instant | None = None,
) -> Answer: ...
def rows_of(
    table: Literal["transitions", "joints", "remarks", "runs"],
    logs: Sequence[_Logs],
    names: Sequence[str] | None = None,
    *,
    machine_from: str = "log",
    **options: Unpack[_ReadOptions],
) -> Table: ...

__VERSION__: str
