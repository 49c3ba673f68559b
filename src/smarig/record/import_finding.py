"""A finding of an import on the data of a run: its sentence, and its kind if a diagnosis or a study asks for it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

FindingKind = Literal[
    "leading output",
    "open loop",
    "varying condition",
    "drop-outs",
    "jump",
    "spikes",
    "clipped channel",
    "clipped output",
    "time gaps",
    "repeated rows",
    "repeated times",
    "noisy input",
    "impossible readings",
    "frozen readings",
    "disagreeing sensors",
    "restarted clock",
    "other starting state",
]
FINDING_KINDS: tuple[FindingKind, ...] = get_args(FindingKind)


@dataclass(frozen=True)
class ImportFinding:
    """``text``: one or two sentences; ``kind``: what was noticed, None where nothing depends on it."""

    text: str
    kind: FindingKind | None = None

    def beginning_with(self, prefix: str) -> "ImportFinding":
        """The same with words before its sentence."""
        return replace(self, text=prefix + self.text)

    @property
    def without_kind(self) -> "ImportFinding":
        """The same as a remark: of a column that is not imported, or of rows that were repaired."""
        return replace(self, kind=None)

    def to_json(self) -> dict[str, str | None]:
        """Plain values, as a run file keeps them."""
        return {"kind": self.kind, "text": self.text}

    @classmethod
    def of(cls, table: Mapping[str, Any], /) -> "ImportFinding":
        """Read a stored table; a kind that this version does not know is none."""
        known = [k for k in FINDING_KINDS if k == table.get("kind")]  # a stranger's may be anything
        return cls(str(table.get("text", "")), known[0] if known else None)


def remarks(*sentences: str) -> list[ImportFinding]:
    """Findings without a kind."""
    return [ImportFinding(s) for s in sentences]
