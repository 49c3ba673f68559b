"""No module reads a sentence: what another module needs to know is a value beside it."""

import ast
import re
from pathlib import Path

import smarig

SOURCE = Path(smarig.__file__).parent
SENTENCE = re.compile(
    r"\b(warnings?|sentences?|remarks?|messages?|headline)\b|\bfindings?\b(?!\.)|\.text\b|\btext\(\)|\bcause\b|str\(e(rror)?\)"
)
METHODS = {
    "startswith",
    "endswith",
    "find",
    "index",
    "count",
    "partition",
    "rpartition",
    "removeprefix",
    "removesuffix",
    "split",
    "match",
    "search",
    "fullmatch",
}
TEXTS_OF_OTHERS = {
    "console/library/library_search.py": "what a person searches for",
    "device/contract/common_requirements.py": "that an error of a driver is one line",
    "device/links/modbus_tcp.py": "the library's error has no other sign of a reply that is missing",
    "exchange/tables/text_table.py": "columns of texts, by their names",
    "report/run_page.py": "levels of events",
}


def asked(node):
    """The source of what a test on a string asks, "" for any other node."""
    if isinstance(node, ast.Compare) and any(isinstance(op, ast.In | ast.NotIn) for op in node.ops):
        return ast.unparse(node.comparators[0])
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in METHODS:
        return " ".join(map(ast.unparse, (node.func.value, *node.args)))
    return ""


def parsed_in(source):
    return [ast.unparse(node) for node in ast.walk(ast.parse(source)) if SENTENCE.search(asked(node))]


def test_a_module_that_parses_a_sentence_is_noticed():
    parsing = [
        "kind = 'jump' if 'jumps' in warning else None",
        "reason = found.text.partition(': ')[2]",
        "known = str(error).startswith('No ')",
        "hit = re.search('leads', sentence)",
    ]
    assert all(parsed_in(line) for line in parsing)
    assert not parsed_in("kind = finding.kind == 'jump' or name in names")


def test_no_module_parses_a_sentence_of_its_own():
    files = {p.relative_to(SOURCE).as_posix(): p.read_text(encoding="utf-8") for p in SOURCE.rglob("*.py")}
    found = {name: lines for name, text in files.items() if (lines := parsed_in(text))}
    assert set(found) == set(TEXTS_OF_OTHERS), {k: v for k, v in found.items() if k not in TEXTS_OF_OTHERS}
