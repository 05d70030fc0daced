"""One function for the batches of Ray, Dask and Spark: logs in, rows out, in the kind of table that came in.

pyarrow and pandas are imported only where a batch is one of theirs.
"""

from . import _core

# Columns that hold logs, where the caller does not say which; "item" is Ray's name for items of a list.
_LOGS = ("log_uri", "uri", "path", "log", "item", "id")


def transitions_of(batch, *, column=None, machine_from="log", **options):
    """The starts and reversals of a batch of logs: the columns of ``report(...).transitions``, ``log_uri``, ``error``.

    A batch is a dict of arrays, a pyarrow table or record batch, a pandas table or series, an iterator of record batches
    (``mapInArrow`` of Spark), or a list of logs. Its logs are paths in ``column``, by default the first of log_uri, uri,
    path, log, item, id. Where it has a column ``bytes`` these are the logs, and ``column`` is what they are called.

    A log that cannot be analysed is a row with its ``error``; one without a start is a row without ``event_index``.
    So every log of the batch is in the result.
    """
    return _rows("transitions", batch, column, {"machine_from": machine_from, **options})


def joints_of(batch, *, column=None, machine_from="log", **options):
    """As ``transitions_of``, a row for each joint."""
    return _rows("joints", batch, column, {"machine_from": machine_from, **options})


def runs_of(batch, *, column=None, machine_from="log", **options):
    """As ``transitions_of``, exactly one row for each log."""
    return _rows("runs", batch, column, {"machine_from": machine_from, **options})


def _rows(table, batch, column, options):
    library = type(batch).__module__.partition(".")[0]
    if library == "pandas":
        frame = batch.to_frame(column or "path") if batch.ndim == 1 else batch
        found = _of_columns(table, frame, column, options)
        return _pyarrow().table(found).to_pandas()
    if library == "pyarrow":
        found = _pyarrow().table(_of_columns(table, batch, column, options, _names(batch)))
        if type(batch).__name__ != "RecordBatch":
            return found
        return (found.to_batches() or [_pyarrow().RecordBatch.from_pylist([], schema=found.schema)])[0]
    if isinstance(batch, dict):
        return _pyarrow().table(_of_columns(table, batch, column, options))
    if isinstance(batch, (list, tuple)):
        return _core.rows_of(table, list(batch), **options)
    if hasattr(batch, "__next__"):
        return (_rows(table, one, column, options) for one in batch)
    raise TypeError(f"expected a batch of logs, not {type(batch).__name__}")


def _pyarrow():
    import pyarrow

    return pyarrow


def _names(batch):
    return batch.schema.names


def _of_columns(table, batch, column, options, names=None):
    names = list(batch) if names is None else names
    column = column or next((name for name in _LOGS if name in names), None)
    data = _values(batch["bytes"]) if "bytes" in names else None
    if column not in names and data is None:
        raise ValueError(f"found no column of logs among {', '.join(map(str, names))}; name it with column=")
    logs = [str(one) for one in _values(batch[column])] if column in names else None
    if data is None:
        return _core.rows_of(table, logs, **options)
    return _core.rows_of(table, data, logs, **options)


def _values(column):
    for name in ("to_pylist", "tolist"):
        if hasattr(column, name):
            return getattr(column, name)()
    return list(column)
