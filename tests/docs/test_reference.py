"""The generated reference is complete: every key, column, option and name has its text and agrees with the
code."""

import importlib

import click
import pytest

import smarig
from docs.json_examples import QUICK, printed_objects
from generate import commands, files, json_objects, keys
from generate.python import PAGES
from smarig.cli import run as cli
from smarig.config import class_comments, file_keys, file_tables
from smarig.core.sample import Quality
from smarig.record import load_run


def test_every_key_of_a_configuration_file_has_a_text():
    silent = [
        f"{where}.{key.name}"
        for model, _ in keys.FILES.values()
        for where, inner in file_tables(model)
        for key in file_keys(inner)
        if not key.meaning
    ]
    assert not silent


def test_units_of_quantities_are_found():
    page = keys.pages()["keys"]
    assert "| `diameter` | quantity | mm | needed |" in page
    assert "| `current_rate_A_per_s` | number, ≥ 1e-06, ≤ 1000000000 | A/s | needed |" in page


def test_every_column_and_key_of_a_file_has_a_text():
    for name, texts in files.columns().items():
        created = [column for column, _ in files._created(name)]
        assert created == list(texts), name
        assert all(texts.values()), name
    assert set(files.QUALITY) == {q.name for q in Quality} | {"GOOD"}
    for where, model in files.models():
        texts = class_comments(model)
        assert all(texts.get(key) for key in model.model_fields), where


def test_every_command_and_option_has_a_text():
    found = dict(commands.all_commands())
    silent = [
        f"{name} {option.opts[0]}"
        for name, command in found.items()
        for option in command.params
        if isinstance(option, click.Option) and not option.help
    ]
    assert not silent
    assert all(f"## smarig {name}\n" in commands.pages()["commands"] for name in found)
    assert set(found) == json_objects.texts().keys() - {"see"}


def unexplained(command, output):
    """Paths of an object that the reference does not know."""
    return sorted(
        {p for p, _ in json_objects.paths(output) if json_objects.explanation_key(command, p) is None}
    )


def test_kept_examples_are_explained_key_by_key():
    for line, output in json_objects.examples():
        assert not unexplained(line.split()[1], output), line


def test_what_commands_print_is_what_is_documented(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SMARIG_HISTORY_DIR", str(tmp_path / ".wires"))
    kept = dict(json_objects.examples())
    for line, output in printed_objects(QUICK):
        assert not unexplained(line.split()[1], output), line
        command = line.split()[1]
        assert _shape(command, output) == _shape(command, kept[line]), line
    _run_keys_have_texts(tmp_path)


def _shape(command, output):
    """The keys that are there, with the types of their values; integers may be numbers that happen to be whole."""
    return {
        (json_objects.explanation_key(command, path), {"int": "float"}.get(kind, kind))
        for path, kind in json_objects.paths(output)
        if kind not in ("NoneType", "empty")
    }


def _run_keys_have_texts(folder):
    found = [key for name in ("fod", "stopped", "mine", "simulated") for key in _run_keys(folder, name)]
    silent = set(found) - files.RUN_KEYS.keys()
    assert not silent
    assert {"imported", "begun_with", "shift"} <= set(found)


def _run_keys(folder, name):
    return load_run(folder / f"{name}.run.sqlite").meta


def test_a_key_that_nobody_explained_would_be_found():
    assert unexplained("verify", {"unit": "mm", "runs": [{"run": "a", "colour": 1}]}) == ["runs[].colour"]
    assert unexplained("characterise", {"verify": {"table": {"runs": [{"colour": 1}]}}})


def test_every_public_name_and_module_is_in_the_reference():
    front = importlib.import_module("generate.python").pages()["python"]
    assert all(f":: smarig.{name}\n" in front for name in smarig.__all__)
    for _, _, modules in PAGES.values():
        for module in modules:
            assert importlib.import_module(module).__doc__, module


def test_it_agrees_with_help(capsys):
    assert cli(["verify", "--help"]) == 0
    words = capsys.readouterr().out.split("Options:")[1]
    page = commands.pages()["commands"].split("## smarig verify\n")[1].split("\n## ")[0]
    for text in ("--select", "Evaluate only the points where this holds"):
        assert text in words
        assert text in page


@pytest.mark.parametrize("module", ["markdown", "docstring", "json_objects"])
def test_examples_in_the_generators(module):
    import doctest

    result = doctest.testmod(importlib.import_module(f"generate.{module}"))
    assert result.attempted
    assert not result.failed
