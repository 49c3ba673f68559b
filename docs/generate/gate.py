"""The table of docs/explanation/safety.md: what a file may name. ``python -m generate.gate``, in docs/."""

from pathlib import Path

from generate.markdown import code, plain, table
from smarig.core import GATED_KEYS, GatedKey, Origin

PAGE = Path(__file__).parents[1] / "explanation" / "safety.md"
START = "<!-- made from the code by `python -m generate.gate`, in docs/ -->\n"
END = "<!-- end of what is made from the code -->\n"
WHO = {
    Origin.INSIDE: "any file",
    Origin.FILE: "a file that you name",
    Origin.USER: "you",
    None: "nobody",
}


def block() -> str:
    """The table between its marks."""
    head = ("in a", "key", "leads to", "who may name it", "otherwise")
    return f"{START}{table(head, map(_row, GATED_KEYS.values()))}{END}"


def with_block(page: str) -> str:
    """The text of the page with the present table."""
    before, _, rest = page.partition(START)
    return before + block() + rest.partition(END)[2]


def _row(row: GatedKey) -> tuple[str, str, str, str, str]:
    otherwise = row.sentence.format(where="FILE", text="PATH", again="PATH")
    return row.place, code(row.key), plain(row.leads_to), WHO[row.least], plain(otherwise)


if __name__ == "__main__":
    PAGE.write_text(with_block(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
