"""What a command must do with a hostile file: end with a sentence or a result, show no secret, execute nothing."""

import re
from pathlib import Path

from hostile.material import SECRET, Material

FINE = (0, 2, 3, 4)  # exit statuses
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
_COLOURS = re.compile(r"\x1b\[\d*m")  # of the viewer's own log
_FORMULA = re.compile(r"""(?:^|[,;\t"'])\s*[=@+-](?![\d.]|inf|nan)""", re.MULTILINE)
LONGEST_MESSAGE = 5000  # characters


def objections(m: Material, status: int, out: str, err: str, folder: Path) -> list[str]:
    """What is wrong with the end of a command; empty if nothing."""
    found = []
    if status not in FINE:
        found.append(f"exit status {status}: {err[-300:]!r}")
    if "Traceback" in err or "Internal error" in err:
        found.append(f"internal error: {err[-300:]!r}")
    if SECRET in out + err or any(SECRET.encode() in p.read_bytes() for p in _files(folder)):
        found.append("shows the secret")
    if m.executed:
        found.append("executed a file")
        (m.folder / "mark").unlink()
    if not m.precious.exists():
        found.append("deleted a file")
        m.precious.write_text("years of work\n" * 10, encoding="utf-8")
    if _CONTROL.search(_COLOURS.sub("", err)):
        found.append(f"control characters in a message: {_CONTROL.findall(err)[:3]}")
    if status and len(err) > LONGEST_MESSAGE:
        found.append(f"a message of {len(err)} characters")
    for table in folder.glob("*.csv"):
        if _FORMULA.search(table.read_text(encoding="utf-8")):
            found.append("a formula in an exported table")
    return found


def _files(folder: Path) -> list[Path]:
    return [p for p in folder.rglob("*") if p.is_file()]
