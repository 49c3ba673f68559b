"""A model is equal after saving and loading, bit for bit; any other file is refused with one sentence."""

import json

import numpy as np
import pytest

from identification.made_runs import driven_run, fod_run
from smarig.core.errors import DataError, UsageError
from smarig.identification.identify import identify
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.replay import load_model

WALK = np.random.default_rng(3).uniform(-10, 180, 300)


@pytest.fixture(scope="module")
def model():
    return identify(
        fod_run("one_e", seed=1, actuator="gorbet_one_wire", rig="one_wire_twin"), "exponential"
    ).model


@pytest.mark.parametrize("kind", ["constant", "parabolic", "exponential", "table"])
def test_round_trip(tmp_path, kind):
    before = identify(fod_run("one_e", seed=1, actuator="gorbet_one_wire"), kind).model
    after = load_model(before.save(tmp_path / "wire.model.json"))
    assert np.array_equal(after.predict(WALK), before.predict(WALK))
    assert np.array_equal(after.covariance, before.covariance)
    for name in (
        "parameters",
        "intervals",
        "fit",
        "noise_floor",
        "provenance",
        "actuator",
        "warnings",
        "created",
    ):
        assert getattr(after, name) == getattr(before, name)
    again = after.save(tmp_path / "again.model.json")
    assert again.read_bytes() == (tmp_path / "wire.model.json").read_bytes()


def test_round_trip_of_mirrored_and_irregular_models(tmp_path):
    ascending = [174.1, 100, 174.1, 60, 100, 174.1, 30, 60, 100, 174.1, 0, 30, 60, 100, 174.1]
    mirrored = identify(driven_run("one_c", ascending), "table").model
    assert isinstance(mirrored.hysteresis, Mirrored)
    irregular = identify(fod_run("one_e"), "table", select="curve%2==1").model
    for k, before in enumerate((mirrored, irregular)):
        after = load_model(before.save(tmp_path / f"{k}.model.json"))
        assert np.array_equal(after.predict(WALK, "positive"), before.predict(WALK, "positive"))
        assert after.mirrored == before.mirrored


def test_a_file_can_be_read_by_eye(tmp_path, model):
    text = model.save(tmp_path / "wire.model.json").read_text()
    data = json.loads(text)
    assert data["hysteresis"]["x"].keys() == {"x2", "x3", "x4", "x5", "x6", "x7"}
    assert data["actuator"]["parameters"]["wire"]["diameter"]["unit"] == "mm"
    assert data["output"] == {"quantity": "position", "unit": "mm"}
    assert data["twin"] is True
    assert max(map(len, text.splitlines())) < 400
    assert len(data["covariance"]) == 8
    assert text.count("\n") < 200


def test_nothing_is_overwritten_without_force(tmp_path, model):
    path = model.save(tmp_path / "wire.model.json")
    with pytest.raises(UsageError, match="--force"):
        model.save(path)
    model.save(path, force=True)
    assert list(tmp_path.iterdir()) == [path]  # no .part left behind


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda d: d.update(extra=1), "'extra' is an unknown key"),
        (lambda d: d.pop("rig"), "'rig' is wrong: Field required"),
        (lambda d: d.update(schema_version=9), "schema version 9"),
        (lambda d: d.pop("format"), "not a model file"),
        (lambda d: d["hysteresis"].update(kind="neural"), "unknown kind of hysteresis 'neural'"),
        (lambda d: d["hysteresis"]["x"].pop("x3"), "requires the parameters x2, x3"),
        (lambda d: d["hysteresis"]["x"].update(x3="steep"), "x3 is 'steep', expected a number"),
        (lambda d: d["hysteresis"]["x"].update(x3=1e308), "x3 is 1e.308; the largest number"),
        (
            lambda d: d.update(effects=[{"name": "creep", "parameters": {"a": 1}}]),
            "creep has no parameter .a.",
        ),
        (
            lambda d: d.update(
                effects=[{"name": "creep", "parameters": {}}], measurement={"effects": [], "amplitudes": []}
            ),
            "effects of the wire or of a measured input, not both",
        ),
        (lambda d: d["hysteresis"].pop("upper"), "'upper' is missing"),
        (lambda d: d["hysteresis"].update(upper=-1.0), "range is empty"),
        (lambda d: d["hysteresis"]["x"].update(x4=0.0), "give no output range"),
        (lambda d: d["hysteresis"].update(colour="red"), "damaged"),
        (lambda d: d.update(covariance=[[1.0]]), "covariance"),
    ],
)
def test_foreign_and_damaged_files_are_refused(tmp_path, model, damage, words):
    path = model.save(tmp_path / "wire.model.json")
    data = json.loads(path.read_text())
    damage(data)
    path.write_text(json.dumps(data))
    with pytest.raises(DataError, match=words) as refused:
        load_model(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "content", [b"", b"[]", b"\xff\xfe\x00", b"SQLite format 3\x00", b"[" * 100_000, b'{"a": NaN']
)
def test_what_is_no_json_is_refused(tmp_path, content):
    path = tmp_path / "x.model.json"
    path.write_bytes(content)
    with pytest.raises(DataError, match="not a model file|is an SQLite database|is empty|was cut off"):
        load_model(path)
    with pytest.raises(UsageError, match="no model file"):
        load_model(tmp_path / "missing.model.json")


def test_repr_gives_the_main_properties(model):
    assert "exponential FodSurface" in repr(model)
    assert "twin data" in repr(model)
    assert "mm" in repr(model)


def put(*where, value):
    """A change of a model file: one other value."""

    def change(data):
        for key in where[:-1]:
            data = data[key]
        data[where[-1]] = value

    return change


INFINITE = float("inf")
IMPOSSIBLE = [
    (put("noise_floor", "value", value=-5.0), "'noise_floor.value' is -5.0, expected a number of 0 or more"),
    (put("noise_floor", "value", value=INFINITE), "'noise_floor.value' is inf, expected a finite number"),
    (put("covariance", 0, 0, value=-1e-6), "a variance below 0: -1e-06 of 'x2'"),
    (put("covariance", 0, 0, value=INFINITE), "'covariance' contains a number that is not finite"),
    (put("covariance", 0, 1, value=1e-3), "'covariance' is not symmetric"),
    (
        lambda d: [put("covariance", *k, value=1.0)(d) for k in ((0, 1), (1, 0))],
        "'covariance' is that of no parameters: it has an eigenvalue below 0",
    ),
    (put("parameters", 1, value="x2"), "'parameters' names one of them twice"),
    (put("intervals", "x2", value=[1.0, -1.0]), "the interval of 'x2' has its ends in the wrong order"),
    (put("intervals", "x2", value=[-INFINITE, 0.0]), "the interval of 'x2' is -inf"),
    (put("fit", "rms", value=-1.0), "'fit.rms' is -1.0, expected a number of 0 or more"),
    (put("fit", "rms", value="small"), "'fit.rms' is 'small', expected a finite number"),
    (put("fit", "points", value=2.5), "'fit.points' is 2.5, expected an integer of 0 or more"),
    (put("fit", "curves", value=-9), "'fit.curves' is -9"),
    (put("fit", "other", value=[INFINITE]), "'fit' contains a number that is not finite"),
    (
        put("fit", "load", value={"condition": "stress", "values": [2, 1]}),
        "'fit.load.values' do not increase",
    ),
    (put("fit", "load", value={"values": [1]}), "'fit.load' does not name its condition"),
    (put("provenance", 0, "rows", value=-3), "'rows' of a run in 'provenance' is -3"),
    (put("provenance", 0, "start_epoch", value=-1e300), "'start_epoch' of a run in 'provenance' is no date"),
    (
        put("provenance", 0, "conditions", value={"stress": {"value": INFINITE, "unit": "MPa"}}),
        "condition 'stress' of a run",
    ),
    (lambda d: d.update(provenance=d["provenance"] * 2000), "'provenance' has 2000 entries, more than 1000"),
    (
        put("actuator", "parameters", "wire", "diameter", "value", value=-0.3),
        "'diameter' of the actuator is -0.3, expected a positive number",
    ),
    (put("name", value="n" * 20_000), "a name or a warning of 20000 characters"),
    (
        put("measurement", value={"effects": [{"name": "input_lag", "parameters": {"lag_s": -3}}]}),
        "'input_lag' of the model needs lag_s between 0 and 1e+07, not -3",
    ),
    (
        put("measurement", value={"effects": [{"name": "ratcheting", "parameters": {"cycles": 0}}]}),
        "'ratcheting' of the model needs cycles between",
    ),
    (
        put(
            "measurement",
            value={
                "effects": [],
                "table": {"condition": "stress", "values": [2, 1], "gains": [1, 1], "zeros": [0, 0]},
            },
        ),
        "its values do not increase",
    ),
    (
        lambda d: d.update(hysteresis={"kind": "mirrored", "image": {"kind": "mirrored", "image": {}}}),
        "the image of a mirrored hysteresis is mirrored itself",
    ),
]


@pytest.mark.parametrize(("change", "words"), IMPOSSIBLE)
def test_numbers_that_cannot_be_are_refused(tmp_path, model, change, words):
    path = model.save(tmp_path / "wire.model.json")
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))
    with pytest.raises(DataError) as refused:
        load_model(path)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_is_not_known_is_read(tmp_path, model):
    """Null stands for a number that the data do not determine."""
    path = model.save(tmp_path / "wire.model.json")
    data = json.loads(path.read_text())
    data["noise_floor"]["value"] = None
    data["intervals"]["x2"] = [None, 1.0]
    data["covariance"][0] = [None] * len(data["parameters"])
    for row in data["covariance"]:
        row[0] = None
    path.write_text(json.dumps(data))
    assert np.isnan(load_model(path).covariance[0]).all()
