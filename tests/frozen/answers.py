"""All questions by name, and the file of their stored answers."""

import json
import lzma
from collections.abc import Callable, Iterable
from fnmatch import fnmatch
from pathlib import Path

from frozen import boxes, old, others, rigs
from frozen.asking import Answer, private, tidy

KEPT = Path(__file__).with_name("answers.json.xz")
SLOW = (
    "box/[1-4]?/best",
    "data/loops/diagnose",
)  # most of the time


class Questions:
    """Asked in one folder, so that a model identified for one question serves the next."""

    def __init__(self, work: Path) -> None:
        self._work = work.resolve()
        parts = (old, rigs, others, boxes)
        self._asked: dict[str, Callable[[], Answer]] = {}
        for part in parts:
            self._asked |= part.questions(self._work)

    @property
    def names(self) -> list[str]:
        """The names that can be computed here; without the measurements of others there are fewer."""
        return list(self._asked)

    def answer(self, name: str) -> Answer:
        """One answer, as it is kept."""
        with private(self._work / "private" / name):
            return json.loads(json.dumps(tidy(self._asked[name](), self._work)))


def wanted(names: Iterable[str], globs: Iterable[str], everything: bool = False) -> list[str]:
    """The requested names: those of the globs, or all but the slowest."""
    if globs:
        return [name for name in names if any(fnmatch(name, glob) for glob in globs)]
    return [name for name in names if everything or not any(fnmatch(name, glob) for glob in SLOW)]


def load(path: Path = KEPT) -> dict[str, Answer]:
    """Answers by name."""
    return json.loads(lzma.decompress(path.read_bytes()))


def save(answers: dict[str, Answer], path: Path) -> None:
    """Compact, keys sorted; numbers as they are, to the last bit."""
    text = json.dumps(answers, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    path.write_bytes(lzma.compress(text.encode(), preset=9 | lzma.PRESET_EXTREME))
