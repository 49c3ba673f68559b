"""Writes a run as a Rerun recording with the layout of the live view, in large batches."""

from pathlib import Path

from smarig.record import AnyRun


def rrd(run: AnyRun, path: Path) -> None:
    """Rerun recording of samples, steps and events as shown by ``smarig view``; needs rerun."""
    from smarig.live import save_recording

    save_recording(run, path)
