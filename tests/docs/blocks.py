"""The fenced blocks of a page in order, and how each is tested.

    sh        every line is a shell command in the page's folder; it must end with status 0, or with the status in its
              comment (``# exit status 2``). A backslash continues a line.
    python    is run; all blocks of a page share their names
    toml, csv, python whose first line is ``# file: NAME``: the rest is written to NAME
    text      is printed by the block before it: its lines occur one after the other in that output,
              where … stands for anything within a line, and a line of … alone for any lines
    {…}       is a directive of MyST and is ignored

No other blocks are allowed. A block below a comment ``<!-- not run: REASON -->`` is not run (installation,
hardware, a window).
"""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

FILE = re.compile(r"# file: (\S+)\n")
NOT_RUN = re.compile(r"<!-- not run: \S.*-->\s*", flags=re.S)
STATUS = re.compile(r"#.*\bexit status (\d+)")
EXTRAS = re.compile(r'pip install -e "\.\[([\w,]+)\]"')
COMMENT = re.compile(r"(^|\s)#.*$")
SHELL_ONLY = re.compile(r"[|&;<>$*`~?(){}\[\]\\]")  # anything but words and quotes
WRITTEN = ("toml", "csv", "python")


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, the line of the page it begins on."""

    language: str
    text: str
    line: int
    run: bool = True

    @property
    def file(self) -> str:
        """The name it is to be written to; "" for none."""
        found = FILE.match(self.text)
        return found[1] if found and self.language in WRITTEN else ""

    @property
    def content(self) -> str:
        """What goes into that file."""
        return self.text.partition("\n")[2]


@dataclass(frozen=True)
class Command:
    """A line of the shell and the exit status that it promises."""

    line: str
    status: int

    @property
    def words(self) -> list[str]:
        """Its words, where it is a plain ``smarig …``, which needs no shell; else none."""
        plain = self.line.startswith("smarig ") and not SHELL_ONLY.search(self.line)
        return shlex.split(self.line)[1:] if plain else []


def blocks(page: Path) -> list[Block]:
    """All fenced blocks of a page but directives."""
    found: list[Block] = []
    above = None
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type == "fence" and not token.info.startswith("{"):
            first = (token.map or [0])[0] + 1
            run = above is None or not NOT_RUN.fullmatch(above.content)
            found.append(Block(token.info.strip(), token.content, first, run))
        above = token if token.type == "html_block" else None
    return found


def extras(page: Path) -> list[str]:
    """The extras that a page says to install."""
    lists = EXTRAS.findall(page.read_text(encoding="utf-8"))
    return [name for names in lists for name in names.split(",")]


def commands(text: str) -> list[Command]:
    """The commands of a ``sh`` block."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        promised = STATUS.search(line)
        command = COMMENT.sub("", line).strip()
        if command:
            found.append(Command(command, int(promised[1]) if promised else 0))
    return found


def printed(sample: str, output: str) -> bool:
    """Whether a sample is what was printed.

    >>> printed("a … c\\n…\\nz", "a b c\\nx\\ny\\nz\\n"), printed("a d", "a b c")
    (True, False)
    """
    pattern = ""
    for line in sample.rstrip().splitlines():
        parts = (re.escape(part.strip()) for part in line.split("…"))
        pattern += r"(?:.*\n)*?" if line.strip() == "…" else r"[ \t]*" + "[^\n]*?".join(parts) + r"[ \t]*\n"
    return bool(re.search(rf"^{pattern}", output + "\n", flags=re.M))
