"""Numbers, TOML files and messages with hostile contents: one short, printable sentence for each."""

import pytest

from smarig.cli.output import report_error
from smarig.core import ConfigError, TomlTable, load_toml, number_from_text, parsed_toml


class Table(TomlTable):
    """A schema with one key."""

    period_s: float


@pytest.mark.parametrize(
    "text",
    ["1_000", "１２", "١٢", "1\u00a0", "−1", "0x10", "", "one", "1,5"],
)
def test_what_only_python_takes_for_a_number_is_none(text):
    with pytest.raises(ValueError, match="not a number|could not convert"):
        number_from_text(text)


HOSTILE = {  # made when they are asked for: every worker collects all tests
    "nested lists": lambda: ("x = " + "[" * 100_000 + "]" * 100_000, "is nested too deeply"),
    "nested tables": lambda: ("x = " + "{a=" * 50_000 + "1" + "}" * 50_000, "is nested too deeply"),
    "a key of many parts": lambda: ("a" + ".a" * 100_000 + " = 1", "a key of more than 200 parts"),
    "a key of many quoted parts": lambda: (
        "'a'" + ' . "a b"' * 100_000 + " = 1",
        "a key of more than 200 parts",
    ),
    "a table of many parts": lambda: ("[[ a" + " .a" * 100_000 + "]]", "a key of more than 200 parts"),
    "an inline key of many parts": lambda: (
        "x = {b = 1, a" + ".a" * 100_000 + " = 1}",
        "more than 200 parts",
    ),
    "an integer": lambda: ("period_s = " + "9" * 100_000, "an integer of too many digits"),
    "a hexadecimal integer": lambda: ("period_s = 0x" + "f" * 100_000, "a value too long to show"),
    "a long key": lambda: ("k" * 1_000_000 + " = 1", "unknown key 'kkk"),
    "many keys": lambda: (
        "\n".join(f"k{k} = 1" for k in range(100_000)),
        "99981 more problems are not listed",
    ),
    "a long text": lambda: (f'period_s = "{"n" * 1_000_000}"', "given: 'nnn"),
    "a large file": lambda: ("#" * 11_000_000, "is larger than 10 MB"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_hostile_toml_file_is_refused_in_a_short_message(tmp_path, kind):
    text, says = HOSTILE[kind]()
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as refusal:
        load_toml(Table, path)
    assert says in str(refusal.value)
    assert len(str(refusal.value)) < 10_000


def test_texts_and_lists_with_many_dots_are_read():
    text = f'a.b = [{"1.5, " * 1000}]\nnote = "{"A sentence. " * 1000}"\nlast = "{"." * 1000}"'
    assert parsed_toml(text)["last"] == "." * 1000


def test_no_message_controls_the_terminal_or_floods_it(capsys):
    report_error("\x1b]0;owned\x07\x1b[2J\u202e" + "x" * 100_000 + "\ud800 end", 4)
    err = capsys.readouterr().err
    assert err.startswith(r"smarig: \x1b]0;owned\x07\x1b[2J\u202exxx")
    assert err.endswith("\\ud800 end\n")
    assert len(err) < 5000
