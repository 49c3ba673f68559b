"""A run as a Rerun recording: the live view of it, with its layout, in big batches; for Rerun's viewer and readers."""

from pathlib import Path

from smarig.record import Run


def rrd(run: Run, path: Path) -> None:
    """The run's samples, steps and events as ``smarig view`` shows them; needs rerun."""
    from smarig.live import save_recording

    save_recording(run, path)
