"""Ranges of ticks: which samples of a damaged run are missing, and which may be wrong."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from smarig.record.table_hashes import KEY, TICKS, block_hash, is_hashed

Ticks = tuple[int, int]  # from, to: both belong to it


def ticks_text(ranges: Iterable[Ticks], most: int = 12) -> str:
    """Ranges of ticks in words.

    >>> ticks_text([(3, 3), (7, 9)])
    '3, 7 to 9'
    """
    texts = [str(a) if a == b else f"{a} to {b}" for a, b in ranges]
    return ", ".join(texts[:most]) + (f" and {len(texts) - most} more ranges" if len(texts) > most else "")


def ticks_json(ranges: Iterable[Ticks]) -> list[dict[str, int]]:
    """Ranges of ticks as JSON holds them."""
    return [{"from": a, "to": b} for a, b in ranges]


def missing_and_unverified(samples: list[tuple], meta: Mapping[str, Any]) -> tuple[list[Ticks], list[Ticks]]:
    """Ranges of ticks that are missing, and of ticks whose samples may hold a wrong value.

    Without hashes (the run was never closed, or is of an older smarig) only gaps between ticks are known.
    """
    if not is_hashed(meta):
        return _gaps(samples), []
    stored = meta.get(KEY)
    by_table: Mapping[str, Any] = stored if isinstance(stored, dict) else {}
    hashes, ticks = by_table.get("sample"), by_table.get(TICKS)
    if not _well_formed(hashes, ticks):
        return _gaps(samples), [(samples[0][0], samples[-1][0])] if samples else []
    return _by_block(samples, hashes or [], ticks or [])


def _by_block(samples: list[tuple], hashes: list[str], ticks: list[int]) -> tuple[list[Ticks], list[Ticks]]:
    """The same by the hash of each block, and its first tick."""
    missing: list[Ticks] = []
    unverified: list[Ticks] = []
    at = 0
    for k, expected in enumerate(hashes):
        last = ticks[k + 1] - (k + 1 < len(hashes))
        begin = at
        while at < len(samples) and samples[at][0] <= last:
            at += 1
        block = samples[begin:at]
        if block_hash(block) != expected:
            absent = list(_absent([row[0] for row in block], ticks[k], last))
            missing += absent
            unverified += [(block[0][0], block[-1][0])] if block else []
    if at < len(samples):
        unverified.append((samples[at][0], samples[-1][0]))
    return _joined(missing), _joined(unverified)


def _well_formed(hashes: Any, ticks: Any) -> bool:
    return (
        isinstance(hashes, list)
        and isinstance(ticks, list)
        and len(ticks) == (len(hashes) + 1 if hashes else 0)
        and all(isinstance(tick, int) for tick in ticks)
        and ticks == sorted(ticks)
    )


def _absent(present: list[int], first: int, last: int) -> Iterator[Ticks]:
    expected = first
    for tick in [*present, last + 1]:
        if tick > expected:
            yield expected, tick - 1
        expected = max(expected, tick + 1)


def _gaps(samples: list[tuple]) -> list[Ticks]:
    ticks = [row[0] for row in samples]
    return list(_absent(ticks, ticks[0], ticks[-1])) if ticks else []


def _joined(ranges: list[Ticks]) -> list[Ticks]:
    """Ranges that touch as one."""
    found: list[Ticks] = []
    for a, b in ranges:
        if found and a <= found[-1][1] + 1:
            found[-1] = (found[-1][0], b)
        else:
            found.append((a, b))
    return found
