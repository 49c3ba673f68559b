"""A command and the forced end of it do not both say how it ended."""

import pytest

from smarig.cli import output


@pytest.mark.parametrize("first", [True, False])
def test_the_first_says_how_the_command_ended(capsys, monkeypatch, first):
    monkeypatch.setattr(output, "_STATE", dict.fromkeys(output._STATE, False))
    assert output.report_error("The first.", 4, forced=first) == 4
    assert output.report_error("The second.", 130, forced=not first) == 130
    assert capsys.readouterr().err == "smarig: The first.\n"


def test_a_program_that_runs_several_commands_prints_every_error(capsys, monkeypatch):
    monkeypatch.setattr(output, "_STATE", dict.fromkeys(output._STATE, False))
    for number in range(2):
        output.report_error(f"Error {number}.", 2)
    assert capsys.readouterr().err == "smarig: Error 0.\nsmarig: Error 1.\n"
