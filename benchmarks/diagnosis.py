"""Success rate of the diagnosis on sealed boxes with no effect, one or two effects, or an unknown effect.

The generator of the boxes shares no code with the diagnosis. The label of a box is opened only after the
answer is written. Each answer is stored at once, so a stopped benchmark can be continued. The number of
workers affects only the time.
"""

import gc
import json
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.blind.score_table import score_table
from benchmarks.blind.trial import Record, trial
from benchmarks.blind.world_table import world_table
from benchmarks.boxes import Part, draw_box
from smarig.core import UsageError

QUICK = 6
CONNECT_TIMEOUT_S = 10
KEYS = {"seed", "number", "category", "hidden", "left_out", "channels"}  # of every answer


def run(
    quick: bool = False,
    boxes: int = 100,
    seed: int = 0,
    workers: int = 1,
    dask: str | None = None,
    out: Path | None = None,
    left_out: bool = False,
    part: Part | None = None,
) -> dict[str, Any]:
    """The table of ``score_table`` over boxes 0 … ``boxes`` − 1 of a seed.

    ``part``, "public" or "sealed": boxes of all worlds from that half, and the table of ``world_table`` as well.

    ``workers``: processes, unless ``dask`` gives the address of a scheduler. ``out``: a file of answers, one
    JSON line per box, continued if it exists. ``left_out``: only boxes whose effect is left out of the
    catalogue.
    """
    if boxes < 1 or workers < 1:
        raise UsageError(f"At least one box and one worker are needed, not {boxes} and {workers}.")
    if part not in (None, "public", "sealed"):
        raise UsageError(f"Boxes have a public and a sealed part, but no part '{part}'.")
    numbers = range(min(QUICK, boxes) if quick else boxes)
    wanted = [k for k in numbers if draw_box(seed, k).left_out] if left_out else numbers
    done = _stored_answers(out, seed, part)
    missing = [k for k in wanted if k not in done]
    for record in _answers(seed, missing, workers, dask, part):
        done[record["number"]] = record
        if out is not None:
            _append(out, {"seed": seed, "part": part} | record)
    answers = [done[k] for k in wanted]
    worlds = {"part": part, "worlds": world_table(answers)} if part else {}
    return {"seed": seed} | score_table(answers) | worlds


def _append(out: Path, record: Record) -> None:
    """Append a line, also after an incomplete last line."""
    whole = not out.exists() or not out.stat().st_size or out.read_bytes()[-1:] == b"\n"
    with out.open("a", encoding="utf-8") as file:
        file.write(("" if whole else "\n") + json.dumps(record) + "\n")


def _stored_answers(out: Path | None, seed: int, part: Part | None) -> dict[int, Record]:
    """The answers in a file with this seed. An incomplete last line is ignored."""
    found: dict[int, Record] = {}
    if out is None or not out.exists():
        return found
    if not out.is_file():
        raise UsageError(f"{out} is not a file that can hold answers.")
    lines = out.read_bytes().splitlines()
    answers = [record for line in lines if (record := _answer_of(line)) is not None]
    if lines and not answers:
        raise UsageError(f"{out} holds something other than answers. Give another name.")
    for record in answers:
        if (record["seed"], record.get("part")) == (seed, part):
            found[record["number"]] = record
    return found


def _answer_of(line: bytes) -> Record | None:
    """The answer in a line, or None if the line holds none."""
    try:
        record = json.loads(line)
    except ValueError:
        return None
    whole = isinstance(record, dict) and record.keys() >= KEYS and ("verdict" in record or "error" in record)
    return record if whole else None


def _answers(
    seed: int, numbers: Sequence[int], workers: int, dask: str | None, part: Part | None
) -> Iterator[Record]:
    if dask is not None:
        yield from _by_dask(seed, numbers, dask, part)
    elif workers == 1:
        yield from (trial(seed, k, part) for k in numbers)
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            for answer in as_completed([pool.submit(trial, seed, k, part) for k in numbers]):
                yield answer.result()


def _by_dask(seed: int, numbers: Sequence[int], address: str, part: Part | None) -> Iterator[Record]:
    try:
        from distributed import Client
        from distributed import as_completed as as_done
    except ImportError:
        raise UsageError("A Dask cluster needs the extra 'scale': pip install 'smarig[scale]'.") from None
    client, reason_text = None, ""
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT_S)
    except (
        OSError,
        ValueError,
        TypeError,
        AssertionError,
    ) as error:  # the last kind: its event loop did not start in time
        reason_text = str(error) or "its client did not start"
    if client is None:
        gc.collect()  # close the objects now; during another client's start this would block for ever
        raise UsageError(f"No Dask scheduler responds at '{address}': {reason_text}.")
    with client:
        for answer in as_done([client.submit(trial, seed, k, part, pure=False) for k in numbers]):
            yield answer.result()
