"""Terms have one meaning: no private words in identifiers, help and messages, and a glossary of existing
names."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import click
import pytest

from computed_once import computed_once
from generate import commands

ROOT = Path(__file__).parents[2]
GLOSSARY = ROOT / "docs/reference/glossary.md"
PACKAGES = ("src", "benchmarks", "simulators")

_WORDS = """
told tell tells telling retold retell retelling untold foretold foretell foretells lived life felt asked asking
sitting sittings said say says speak wary draught draughts judge judged proved examined outdone moral drama honesty
patience remnant remnants ledger stretch stretches belief beliefs believed hurt mortal story stories fairy beside
alike gone begun planted lookalike lookalikes
"""
_UNCLEAR = "told untold foretold foretells retold sitting sittings felt lived draught draughts fairy outdone"
PRIVATE = frozenset(_WORDS.split())
IDENTIFIERS_THAT_STAY = {
    "draught_K": "key of the labels of sealed boxes that are on disk, and of the frozen answers",
}
PRIVATE_IN_MESSAGES = frozenset(_UNCLEAR.split())
REPEATED_MODULES = {
    "__init__": "every package has one",
    "characterise": "command of the command line, and what it does",
    "calibrate": "command of the command line, and what it does",
    "identify": "command of the command line, and what it does",
    "verify": "command of the command line, and what it does",
    "diagnose": "command of the command line, and what it does",
    "csv": "a reader and a writer of one format",
    "mat": "a reader and a writer of one format",
    "study": "command of the command line, and what it does",
    "parquet": "a reader and a writer of one format",
    "pi": "the tracking controller and the set-point controller of that name, each in its catalogue",
    "inverse": "the inverse of the operator, and the tracking controller of that name in the catalogue",
    "measured_input": "the drive of a simulation (plant), and how it is taken from runs (replay)",
}


def words(identifier: str) -> Iterator[str]:
    """Split at underscores and capitals, in small letters."""
    for part in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", identifier):
        yield part.lower()


@dataclass(frozen=True)
class Names:
    """What the tests ask of a module; its syntax tree is dropped (all of them hold 165 MB)."""

    identifiers: frozenset[str]
    classes: tuple[str, ...]
    functions: frozenset[str]
    messages: tuple[tuple[int, str], ...]

    @classmethod
    def of(cls, tree: ast.Module) -> "Names":
        every = tuple(ast.walk(tree))
        return cls(
            frozenset(identifiers(every)),
            tuple(node.name for node in every if isinstance(node, ast.ClassDef)),
            frozenset(node.name for node in tree.body if isinstance(node, ast.FunctionDef)),
            tuple(message_words(every)),
        )


def module_files() -> list[Path]:
    """The files of all modules of the packages."""
    return sorted(f for package in PACKAGES for f in (ROOT / package).rglob("*.py"))


@computed_once
def modules() -> dict[Path, Names]:
    """All modules of the packages."""
    return {f: Names.of(ast.parse(f.read_text(encoding="utf-8"))) for f in module_files()}


@cache
def words_of(identifier: str) -> frozenset[str]:
    """The words of an identifier; most occur often."""
    return frozenset(words(identifier))


def identifiers(nodes: tuple[ast.AST, ...]) -> Iterator[str]:
    """Names of classes, functions, arguments, keywords, attributes, variables and imports."""
    for node in nodes:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.arg | ast.keyword):
            yield node.arg or ""
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.alias):
            yield node.asname or node.name
        elif isinstance(node, ast.ExceptHandler | ast.MatchAs | ast.MatchStar):
            yield node.name or ""


def private_identifiers(module: Names) -> set[str]:
    return {name for name in module.identifiers if PRIVATE & words_of(name)} - IDENTIFIERS_THAT_STAY.keys()


def classes() -> Counter[str]:
    """How often each class name is defined."""
    return Counter(name for module in modules().values() for name in module.classes)


def message_words(nodes: tuple[ast.AST, ...]) -> Iterator[tuple[int, str]]:
    """(line, word) of the unclear words in the literals of all that is raised."""
    for node in nodes:
        if isinstance(node, ast.Raise) and node.exc is not None:
            for inner in ast.walk(node.exc):
                if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                    hits = PRIVATE_IN_MESSAGES.intersection(words(inner.value))
                    yield from ((inner.lineno, word) for word in sorted(hits))


def helps(name: str, command: click.Command) -> Iterator[tuple[str, str]]:
    """(where, text) of a command and of its options."""
    yield name, command.help or ""
    for option in command.params:
        if isinstance(option, click.Option):
            yield f"{name} {option.opts[0]}", option.help or ""


def entries() -> list[tuple[str, str]]:
    """(term, where in the code) of each row of the glossary."""
    rows = []
    for line in GLOSSARY.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in re.sub(r"^\||\|$", "", line).split("|")]
        if line.startswith("| **"):
            assert len(cells) == 5, f"term, meaning, symbol, source, code: {line}"
            rows.append((cells[0].replace("*", ""), cells[4]))
    return rows


def test_no_identifier_has_a_private_word():
    found = {
        f"{file.relative_to(ROOT)}: {name}"
        for file, module in modules().items()
        for name in private_identifiers(module) | (PRIVATE & set(words(file.stem)))
    }
    assert not found


def test_the_exceptions_are_needed():
    present = {name for module in modules().values() for name in module.identifiers}
    assert IDENTIFIERS_THAT_STAY.keys() <= present


@pytest.mark.parametrize(
    "code",
    [
        "class Told: ...",
        "def f(felt_K): ...",
        "x.told = 1",
        "sitting = 1",
        "f(asked_A=2)",
        "import a as story",
    ],
)
def test_a_private_word_is_found(code):
    assert private_identifiers(Names.of(ast.parse(code)))


def test_no_help_text_has_a_private_word():
    found = {
        where: hit
        for name, command in commands.all_commands()
        for where, text in helps(name, command)
        if (hit := PRIVATE & set(words(text)))
    }
    assert not found


def test_no_error_message_has_a_private_word():
    found = [
        f"{file.relative_to(ROOT)}:{line}: {word}"
        for file, module in modules().items()
        for line, word in module.messages
    ]
    assert not found


def test_no_class_name_is_defined_twice():
    assert [name for name, n in classes().items() if n > 1] == []


def test_module_names_repeat_only_where_the_folder_makes_the_difference_plain():
    found = Counter(file.stem for file in module_files() if file.is_relative_to(ROOT / "src"))
    assert {name for name, n in found.items() if n > 1} == REPEATED_MODULES.keys()


def test_every_name_of_the_glossary_exists():
    known = classes().keys() | {file.stem for file in modules()} | {file.parent.name for file in modules()}
    known |= {name for module in modules().values() for name in module.functions}
    named = {name for _, code in entries() for name in re.findall(r"`([A-Za-z_]+)`", code)}
    assert named
    assert named <= known


def test_every_term_is_defined_once():
    found = Counter(term.lower() for term, _ in entries())
    assert len(found) > 140
    assert [term for term, n in found.items() if n > 1] == []


def test_the_glossary_lists_the_words_that_are_not_used():
    _, listed = GLOSSARY.read_text(encoding="utf-8").split("## Words not used")
    assert set(words(listed)) >= PRIVATE
