"""Plug-ins are found by the metadata of their distributions, imported only when named, and fail in one sentence."""

import sys

import pytest

from cli.plugin_site import install
from smarig.core import catalogue, plugin
from smarig.core.catalogue import (
    catalogue_entry,
    catalogue_names,
    own_entries,
    own_file_error,
    own_files,
    resolve_name,
    use_plugin,
)
from smarig.core.errors import UsageError
from smarig.plant.effect_catalogue import (
    EFFECTS,
    effects_from_arguments,
    effects_from_pairs,
    effects_to_arguments,
)
from smarig.protocols._settings import PROTOCOLS

PROTOCOL = 'def {0}(setup, *, n: int = 3):\n    """Stand still."""\n    yield 1 / (n - 3)\n'
EFFECT = (
    "from smarig.plant import EffectType, Parameter, Stage\n"
    "{0} = EffectType('{0}', 'Longer.', 'own', '', '', (), '',\n"
    "    (Parameter('percent', '%', 0.0, 10.0, 1.0, ''),),\n"
    "    lambda p, setup: {{Stage.OUTPUT: lambda y, now: y * (1 + p['percent'] / 100)}})\n"
)


@pytest.fixture
def site(tmp_path, monkeypatch):
    """A folder on sys.path into which distributions are installed; their modules are forgotten afterwards."""
    folder, before = tmp_path / "site", set(sys.modules)
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    with own_files():
        yield folder
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", None)).startswith(str(folder)):
            del sys.modules[name]


@pytest.fixture
def lab(site):
    """One distribution with a protocol and an effect."""
    modules = {
        "lab/__init__.py": "",
        "lab/still.py": PROTOCOL.format("still"),
        "lab/long.py": EFFECT.format("long"),
    }
    points = {"smarig.protocols": {"still": "lab.still:still"}, "smarig.effects": {"long": "lab.long:long"}}
    install(site, "lab-tests", "1.2", points, modules)
    return site


def imported() -> list[str]:
    return [name for name in sys.modules if name.partition(".")[0] == "lab"]


def test_a_typed_name_is_imported_and_joins_the_catalogue_until_the_command_ends(lab):
    before = catalogue_names(PROTOCOLS)
    assert plugin.offered_names(PROTOCOLS) == ["still"]
    assert imported() == []
    with own_files():
        assert resolve_name(PROTOCOLS, "still") == "still"
        assert sorted(imported()) == ["lab", "lab.still"], "only the one that was named"
        assert catalogue_entry(PROTOCOLS, "still").__name__ == "still"
        assert set(catalogue_names(PROTOCOLS)) - set(before) == {"still"}
        entry = own_entries(PROTOCOLS)["still"]
        assert entry.offer is not None
        assert (entry.offer.origin, entry.reference, entry.text) == (
            "lab-tests 1.2",
            "still",
            PROTOCOL.format("still"),
        )
    assert catalogue_names(PROTOCOLS) == before


def test_a_stored_name_is_never_imported_and_names_the_distribution(lab):
    for read in (
        lambda: catalogue_entry(PROTOCOLS, "still"),
        lambda: effects_from_pairs(["long=2"]),
        lambda: catalogue.catalogue_summary(PROTOCOLS, "still"),
    ):
        with pytest.raises(UsageError, match=r"is a plug-in of lab-tests 1\.2, which .* smarig --plugin"):
            read()
    assert imported() == []
    assert resolve_name(PROTOCOLS, "long") == "long", "an effect is no protocol"
    assert imported() == []


def test_effects_by_name_are_written_so_that_another_process_imports_them(lab):
    (effect,) = effects_from_arguments(["long.percent=3"])
    assert effect.values == {"percent": 3.0}
    assert effects_to_arguments([effect]) == ["long.percent=3.0"]


def test_unknown_names_suggest_plugins(lab):
    with pytest.raises(UsageError, match=r"No protocol 'stil'; did you mean still\?"):
        catalogue_entry(PROTOCOLS, resolve_name(PROTOCOLS, "stil"))


def test_use_plugin_imports_every_kind_of_that_name(lab):
    install(
        lab, "more", "3", {"smarig.protocols": {"long": "more:long"}}, {"more.py": PROTOCOL.format("long")}
    )
    assert use_plugin("long") == ["smarig.plant.effects", "smarig.protocols"]
    assert catalogue_entry(EFFECTS, "long").name == "long"
    with pytest.raises(
        UsageError, match=r"No installed distribution offers a plug-in 'lang'; did you mean long\?"
    ):
        use_plugin("lang")


def test_an_error_in_a_plugin_is_reported_with_its_distribution_and_line(lab):
    resolve_name(PROTOCOLS, "still")
    with pytest.raises(ZeroDivisionError) as failed:
        next(catalogue_entry(PROTOCOLS, "still")(None))
    place = lab / "lab" / "still.py"
    assert (
        own_file_error(failed.value)
        == f"lab-tests 1.2: {place}, line 3: ZeroDivisionError: division by zero."
    )


BROKEN = {
    "its module is missing": ("nowhere:mine", "", r"cannot be used: its module 'nowhere' is missing"),
    "its submodule is missing": (
        "bad.nowhere:mine",
        "",
        r"ModuleNotFoundError: No module named 'bad.nowhere'",
    ),
    "it raises": ("bad:mine", "1 / 0\n", "cannot be imported: ZeroDivisionError: division by zero"),
    "it exits": ("bad:mine", "raise SystemExit('bye')\n", "cannot be imported: SystemExit: bye"),
    "it is no Python": ("bad:mine", "def mine(:\n", "cannot be imported: SyntaxError"),
    "it lacks the object": ("bad:mine", "x = 1\n", "cannot be imported: AttributeError: .*'mine'"),
    "it has another type": ("bad:mine", "mine = 3\n", "cannot be used: mine must be an EffectType"),
    "it is a module": ("bad", "mine = 3\n", "cannot be used: mine must be an EffectType"),
    "it has another name": (
        "bad:mine",
        EFFECT.format("yours") + "mine = yours\n",
        'has name="yours", but must have',
    ),
    "its target is empty": ("", "", "cannot be used: its module '' is missing"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_plugin_is_one_sentence_that_names_the_distribution(lab, what):
    target, text, sentence = BROKEN[what]
    install(lab, "bad-lab", "0.1", {"smarig.effects": {"mine": target}}, {"bad/__init__.py": text})
    with pytest.raises(UsageError, match=rf"^The effect 'mine' of bad-lab 0\.1 .*{sentence}") as refusal:
        resolve_name(EFFECTS, "mine")
    assert "\n" not in str(refusal.value)
    assert not own_entries(EFFECTS)
    assert resolve_name(EFFECTS, "long") == "long", "others remain usable"
    assert list(own_entries(EFFECTS)) == ["long"]
    for name in ("bad", "bad.nowhere"):
        sys.modules.pop(name, None)


def test_a_name_of_smarig_is_not_replaced(lab):
    install(
        lab, "thief", "1", {"smarig.effects": {"creep": "thief:creep"}}, {"thief.py": "raise SystemExit\n"}
    )
    assert resolve_name(EFFECTS, "creep") == "creep"
    assert not own_entries(EFFECTS)
    with pytest.raises(
        UsageError, match=r"'creep' of thief 1 cannot be used: 'creep' is the name of a shipped"
    ):
        use_plugin("creep")
    assert "thief" not in sys.modules


def test_what_a_plugin_prints_on_import_is_no_result(lab, capsys):
    install(
        lab,
        "loud",
        "1",
        {"smarig.protocols": {"loud": "loud:loud"}},
        {"loud.py": "print('hello')\n" + PROTOCOL.format("loud")},
    )
    resolve_name(PROTOCOLS, "loud")
    assert capsys.readouterr() == ("", "hello\n")


def test_two_distributions_with_one_name_are_refused(lab):
    install(
        lab, "other", "7", {"smarig.effects": {"long": "other:long"}}, {"other.py": EFFECT.format("long")}
    )
    with pytest.raises(
        UsageError, match=r"'long' is offered by several distributions: lab-tests 1\.2 and other 7\."
    ):
        resolve_name(EFFECTS, "long")
    assert imported() == []


def test_a_distribution_that_cannot_be_read_hides_no_other(lab):
    info = install(lab, "torn", "1", {})
    (info / "entry_points.txt").write_text("[smarig.effects]\nno equals sign\n")
    offers, faults = plugin.plugin_offers()
    assert {offer.name for offer in offers} == {"still", "long"}
    assert len(faults) == 1
    assert "entry points of the distribution torn cannot be read" in faults[0]


def test_a_plugin_and_an_own_file_of_one_name_are_not_mixed_up(lab, tmp_path):
    (tmp_path / "still.py").write_text(PROTOCOL.format("still"))
    resolve_name(PROTOCOLS, "still")
    with pytest.raises(UsageError, match="have the same name"):
        resolve_name(PROTOCOLS, str(tmp_path / "still.py"))


@pytest.mark.parametrize("group", plugin.PLUGIN_GROUPS)
def test_every_group_extends_a_catalogue_that_checks_its_entries(group):
    package = plugin.PLUGIN_GROUPS[group]
    misfit = __import__(package, fromlist=["misfit"]).misfit
    names = catalogue_names(package)
    assert names
    assert [misfit(name, catalogue_entry(package, name)) for name in names] == [""] * len(names)
    assert misfit("mine", 3)
