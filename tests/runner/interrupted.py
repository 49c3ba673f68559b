"""Runs as a killed process leaves them: a finished run cut at a tick, without its end."""

import shutil
import sqlite3
from pathlib import Path

# What is written when a run is closed, and is missing when its process is killed.
AT_THE_END = ("end", "hashes", "history_until_tick")


def cut(run: Path, out: Path, tick: int) -> Path:
    """A copy of a run of which everything after a tick was never written."""
    shutil.copy(run, out)
    with sqlite3.connect(out) as db:
        (t_s,) = db.execute("SELECT t_s FROM sample WHERE tick = ?", (tick,)).fetchone()
        db.execute("DELETE FROM sample WHERE tick > ?", (tick,))
        db.execute("DELETE FROM step WHERE t_end_s > ?", (t_s,))
        db.execute("DELETE FROM event WHERE t_s > ? OR kind = 'end'", (t_s,))
        db.executemany("DELETE FROM run WHERE key = ?", [(key,) for key in AT_THE_END])
    db.close()
    return out
