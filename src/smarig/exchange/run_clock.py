"""The time of a run's samples in the host's time, for formats that need one."""

from smarig.record import AnyRun, is_timestamp


def zero_epoch(run: AnyRun) -> float | None:
    """The host time, in seconds since 1970, of the zero of the device's clock; None if it was not recorded."""
    starts = (e for e in run.events if e.kind == "start" and is_timestamp(e.data.get("epoch")))
    began = next(starts, None)
    if began is not None:
        return float(began.data["epoch"]) - began.t_s
    start = run.info.start_epoch
    return None if start is None else float(start)
