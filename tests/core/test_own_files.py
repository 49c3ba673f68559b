"""An own file joins its catalogue when a user gives its path; its errors are one sentence with file and
line."""

import pytest

from smarig.control.controller_settings import TRACKING_CONTROLLERS as CONTROLLERS
from smarig.core import catalogue
from smarig.core.catalogue import (
    catalogue_entry,
    catalogue_names,
    own_entries,
    own_file_error,
    own_files,
    resolve_name,
)
from smarig.core.errors import UsageError
from smarig.plant.effect_catalogue import (
    EFFECTS,
    effects_from_arguments,
    effects_from_pairs,
    effects_to_arguments,
    effects_to_pairs,
    mystery_effects,
)
from smarig.protocols._settings import PROTOCOLS

GOOD = 'def mine(setup, *, n: int = 3):\n    """Stand still."""\n    yield from ()\n'


@pytest.fixture(autouse=True)
def _alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with own_files():
        yield


@pytest.fixture
def stretch_effect(tmp_path):
    """An effect of one's own, in a folder with awkward signs."""
    folder = tmp_path / "a=b.py.c"
    folder.mkdir()
    (folder / "stretch.py").write_text(
        "from smarig.plant.effect import EffectType, Parameter, Stage\n"
        "stretch = EffectType('stretch', 'Longer.', 'own', '', '', (), '',\n"
        "    (Parameter('percent', '%', 0.0, 10.0, 1.0, ''), Parameter('from_mm', 'mm', 0.0, 9.0, 0.0, '')),\n"
        "    lambda p, setup: {Stage.OUTPUT: lambda y, now: y * (1 + p['percent'] / 100)})\n"
    )
    return folder / "stretch.py"


def test_it_joins_the_catalogue_until_the_command_ends(tmp_path):
    (tmp_path / "mine.py").write_text(GOOD)
    before = catalogue_names(PROTOCOLS)
    with own_files():
        assert resolve_name(PROTOCOLS, "./mine.py") == "mine"
        assert set(catalogue_names(PROTOCOLS)) - set(before) == {"mine"}
        assert catalogue_entry(PROTOCOLS, "mine").__name__ == "mine"
        assert catalogue.catalogue_summary(PROTOCOLS, "mine") == "Stand still."
        assert own_entries(PROTOCOLS)["mine"].text == GOOD
    assert catalogue_names(PROTOCOLS) == before


def test_names_and_file_contents_load_nothing(tmp_path):
    """Only ``resolve_name`` executes: a path in a run or a model gets no further than a name that is not there."""
    (tmp_path / "mine.py").write_text("raise SystemExit('executed')\n")
    assert resolve_name(PROTOCOLS, "validation") == "validation"
    with pytest.raises(UsageError, match=r"No protocol '\./mine\.py'"):
        catalogue_entry(PROTOCOLS, "./mine.py")
    with pytest.raises(UsageError, match="No effect ''"):
        effects_from_pairs(["./mine.py=3"])
    with pytest.raises(UsageError, match="executed"):
        resolve_name(PROTOCOLS, "./mine.py")


def test_a_changed_file_is_loaded_again_and_hashed_as_executed(tmp_path):
    (tmp_path / "mine.py").write_text(GOOD)
    resolve_name(PROTOCOLS, "./mine.py")
    first = own_entries(PROTOCOLS)["mine"]
    resolve_name(PROTOCOLS, str(tmp_path / "mine.py"))
    assert own_entries(PROTOCOLS)["mine"] is first
    (tmp_path / "mine.py").write_text(GOOD.replace("= 3", "= 4"))
    resolve_name(PROTOCOLS, "./mine.py")
    assert catalogue_entry(PROTOCOLS, "mine").__kwdefaults__ == {"n": 4}
    assert own_entries(PROTOCOLS)["mine"].sha256 != first.sha256


def test_two_files_of_one_name_are_refused(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mine.py").write_text(GOOD)
    resolve_name(PROTOCOLS, "a/mine.py")
    with pytest.raises(UsageError, match=r"^b/mine\.py and a/mine\.py have the same name"):
        resolve_name(PROTOCOLS, "b/mine.py")


WRONG = {
    "def mine(:\n": "^mine.py, line 1: invalid syntax",
    "x = 1\nimport nowhere\n": "^mine.py, line 2: ModuleNotFoundError: No module named 'nowhere'.$",
    "x = 1\n\0": "mine.py.*null bytes",
    "def yours(setup):\n    yield\n": "^mine.py defines no 'mine': the protocol must have the file's name.$",
    "mine = 3\n": "it is of type int",
    "def mine(*, n: int = 3):\n    yield\n": "it has no argument setup",
    "def mine(setup, n: int = 3):\n    yield\n": "'n' must come after the *",
    "def mine(setup, *, n: int):\n    yield\n": "'n' has no default",
    "def mine(setup, *, n=3):\n    yield\n": "'n' has no type",
    "def mine(setup, *, n: 'Nowhere' = 3):\n    yield\n": "types cannot be resolved",
}


@pytest.mark.parametrize(("text", "sentence"), WRONG.items())
def test_a_wrong_protocol_is_one_sentence(tmp_path, text, sentence):
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(UsageError, match=sentence) as refusal:
        resolve_name(PROTOCOLS, "./mine.py")
    assert "\n" not in str(refusal.value)
    assert not own_entries(PROTOCOLS)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("./gone.py", "^There is no file gone.py.$"),
        ("./folder.py", "^folder.py is a folder"),
        ("./not-a-name.py", "'not-a-name' is not a valid Python name"),
        ("./validation.py", "'validation' is the name of a shipped protocol"),
        ("./latin.py", "is not a UTF-8 text file"),
    ],
)
def test_a_file_that_cannot_be_it_is_one_sentence(tmp_path, name, sentence):
    (tmp_path / "folder.py").mkdir()
    (tmp_path / "latin.py").write_bytes(b"\xff\xfe")
    for file in ("not-a-name.py", "validation.py"):
        (tmp_path / file).write_text(GOOD)
    with pytest.raises(UsageError, match=sentence):
        resolve_name(PROTOCOLS, name)


@pytest.mark.parametrize(
    ("package", "text", "sentence"),
    [
        (EFFECTS, "mine = 3", "must be an EffectType"),
        (
            EFFECTS,
            "from smarig.plant.effects.walking import walking as mine",
            'has name="walking", but must have name="mine"',
        ),
        (
            EFFECTS,
            "from dataclasses import replace\nfrom smarig.plant.effects.walking import walking as w\n"
            "mine = replace(w, name='mine', parameters=())",
            "its bounds must include 0",
        ),
        (CONTROLLERS, "mine = 3", "it is of type int"),
        (CONTROLLERS, "def mine(wanted): yield 0.0", "it lacks the parameters known and wanted"),
        (CONTROLLERS, "def mine(known, *, wanted): yield 0.0", "it lacks the parameters known and wanted"),
        (CONTROLLERS, "def mine(known, wanted, k=1.0): yield 0.0", r"'k' must come after the \*"),
        (CONTROLLERS, "def mine(known, wanted, *, k): yield 0.0", "'k' has no default"),
        (CONTROLLERS, "def mine(known, wanted, *, k=3): yield 0.0", r"number 'k' is an integer: write 3\.0"),
        (
            CONTROLLERS,
            "def mine(known, wanted, *, k=True): yield 0.0",
            "number 'k' is True; it must be a finite",
        ),
        (
            CONTROLLERS,
            "def mine(known, wanted, *, k=-1.0): yield 0.0",
            "number 'k' is -1.0; it must be a finite",
        ),
        (
            CONTROLLERS,
            "def mine(known, wanted, *, k=1e999): yield 0.0",
            "number 'k' is inf; it must be a finite",
        ),
        ("smarig.device.drivers", "def mine(where): ...", r"must be a function mine\(where, rig\)"),
        ("smarig.device.drivers", "mine = 3", r"must be a function mine\(where, rig\)"),
    ],
)
def test_a_wrong_effect_controller_or_driver_is_one_sentence(tmp_path, package, text, sentence):
    (tmp_path / "mine.py").write_text(text)
    with pytest.raises(UsageError, match=sentence):
        resolve_name(package, "./mine.py")


@pytest.mark.parametrize("package", [PROTOCOLS, EFFECTS, CONTROLLERS, "smarig.device.drivers"])
def test_everything_that_ships_would_pass_as_an_own_file(package):
    misfit = __import__(package, fromlist=["misfit"]).misfit
    assert [misfit(name, catalogue_entry(package, name)) for name in catalogue_names(package)] == [""] * len(
        catalogue_names(package)
    )


def test_own_effects_are_written_like_others(stretch_effect):
    (planted,) = effects_from_arguments([f"{stretch_effect}=3", f"{stretch_effect}.from_mm=2"])
    assert planted.values == {"percent": 3.0, "from_mm": 2.0}
    assert effects_from_arguments([str(stretch_effect)])[0].strength == 1.0
    assert effects_to_pairs([planted]) == ["stretch.percent=3.0", "stretch.from_mm=2.0"]
    assert effects_from_arguments(effects_to_arguments([planted])) == (planted,)
    assert effects_to_arguments(effects_from_arguments(["creep=2"])) == ["creep.percent_per_decade=2.0"]


def test_a_mystery_is_drawn_from_what_ships(stretch_effect):
    before = [mystery_effects(seed, "one_wire") for seed in range(40)]
    resolve_name(EFFECTS, str(stretch_effect))
    assert [mystery_effects(seed, "one_wire") for seed in range(40)] == before


def test_an_error_in_an_own_file_is_reported_with_its_line(tmp_path):
    (tmp_path / "mine.py").write_text(GOOD.replace("yield from ()", "yield 1 / (n - 3)"))
    resolve_name(PROTOCOLS, "./mine.py")
    with pytest.raises(ZeroDivisionError) as failed:
        next(catalogue_entry(PROTOCOLS, "mine")(None))
    assert own_file_error(failed.value) == "mine.py, line 3: ZeroDivisionError: division by zero."
    with pytest.raises(ZeroDivisionError) as ours:
        1 / 0  # noqa: B018 - it fails
    assert own_file_error(ours.value) == ""
