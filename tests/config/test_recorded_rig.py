"""The recorded text of a rig is the rig: of every file that ships, and of chains of bases."""

import pytest

from smarig.config import load_rig, rig_from_text, rig_text, shipped_names

CHAIN = {
    "top": 'name = "top"\nbase = "middle.toml"\nlease_s = 3.0\n\n[limits]\ncurrent_max_A = 0.5\n',
    "middle": '# between\nbase = "one_wire_serial"\n[simulator]\nspeed = 2.0\n',
}


@pytest.mark.parametrize("name", shipped_names("rigs"))
def test_the_text_of_a_rig_gives_its_values(name):
    assert rig_from_text(rig_text(name)) == load_rig(name)


def test_a_chain_of_bases_gives_its_values(tmp_path):
    for name, text in CHAIN.items():
        (tmp_path / f"{name}.toml").write_text(text, "utf-8")
    rig = str(tmp_path / "top.toml")
    found = rig_from_text(rig_text(rig))
    assert found is not None
    assert (found.lease_s, found.limits.current_max_A, found.simulator.speed) == (3.0, 0.5, 2.0)
    assert found.model_copy(update={"base": load_rig(rig).base}) == load_rig(rig)


@pytest.mark.long("takes two seconds", cases=("text4", "text5"))
@pytest.mark.parametrize(
    "text",
    [
        *("", "name = 3", '{"a": 1}', "a = " + "[" * 100_000),
        *('base = "x"\n' * 3000, 'base = "x"\n#\n' * 3000, "#\n" * 150_000),
    ],
)
def test_another_text_is_no_rig(text):
    """Also one that has a great many divisions, in a bounded time."""
    assert rig_from_text(text) is None
