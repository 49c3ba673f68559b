"""How far a long computation has come, for whoever shows it. The outermost loop of a process counts."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

Item = TypeVar("Item")


@dataclass
class _Share:
    """Items done of a total; no total outside a loop."""

    done: int = 0
    total: int = 0


_SHARE = _Share()


def counted(items: Iterable[Item], total: int) -> Iterator[Item]:
    """The items, each counted when the next one is requested. Loops inside another counted loop do not count.

    >>> list(counted("ab", 2))
    ['a', 'b']
    """
    if _SHARE.total or total < 1:
        yield from items
        return
    _SHARE.done, _SHARE.total = 0, total
    try:
        for item in items:
            yield item
            _SHARE.done += 1
    finally:
        _SHARE.done, _SHARE.total = 0, 0


def share_done() -> tuple[int, int]:
    """Items done and the total of the running loop; (0, 0) outside one."""
    return _SHARE.done, _SHARE.total
