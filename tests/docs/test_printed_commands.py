"""Every command of smarig that the README or a page prints is taken by its parser: command, options and values.

Whether it does what the page says, ``test_readme.py`` and ``test_blocks.py`` show by running it.
"""

import re

import click
import pytest

from docs.blocks import blocks, commands
from docs.generate.commands import all_commands
from docs.test_blocks import DOCS, WITH_BLOCKS

KNOWN = dict(all_commands())
OWN = re.compile(r" \./| my_lab|--help$")  # files and plug-ins that the reader makes


def printed(page):
    """The commands of a page that end with status 0."""
    return [
        command
        for block in blocks(page)
        if block.language == "sh"
        for command in commands(block.text)
        if command.words and command.status == 0 and not OWN.search(command.line)
    ]


@pytest.mark.parametrize("page", [DOCS.parent / "README.md", *WITH_BLOCKS], ids=lambda page: page.stem)
def test_they_are_taken(page):
    for command in printed(page):
        name, *words = command.words
        with KNOWN[name].make_context(name, words):
            pass


def test_there_are_many():
    assert sum(len(printed(page)) for page in WITH_BLOCKS) > 90


def test_what_no_parser_takes_is_seen():
    with pytest.raises(click.UsageError, match="No such option"):
        KNOWN["run"].make_context("run", ["validation", "--rigg", "one_wire_twin"])
