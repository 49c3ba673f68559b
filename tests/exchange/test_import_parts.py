"""Parts of one record, imported as several files: the memory goes on from part to part."""

import re

import numpy as np
import pytest

from smarig.core.errors import DataError, UsageError
from smarig.exchange import import_file
from smarig.identification import identify, verify
from smarig.measurement import input_records
from smarig.preisach import Preisach
from smarig.record import load_run
from smarig.replay import simulate_runs

MAPPING = """
name = "parts"
summary = "A test."
source = "this test"
steps = "rows"
initial = "negative"
[columns]
input = { column = "u", unit = "V" }
position = { column = "y", unit = "um" }
[input]
channel = "input"
quantity = "voltage"
unit = "V"
[output]
quantity = "displacement"
unit = "um"
"""
CUT = 70  # half way down a minor loop, far from both ends


def _record():
    corners = [0.0, 10.0, 2.0, 8.0, 4.0, 9.0, 0.0]
    u = np.concatenate([np.linspace(a, b, 21)[1:] for a, b in zip(corners, corners[1:])])
    alpha, beta = np.meshgrid(np.linspace(0, 10, 15), np.linspace(0, 10, 15))
    pairs = alpha > beta + 0.5
    relays = Preisach.from_measure(alpha[pairs], beta[pairs], np.ones(pairs.sum()))
    return u, relays.simulate(u)


@pytest.fixture
def part(tmp_path):
    """Import rows of the record as a part of their own."""
    u, y = _record()
    (tmp_path / "map.toml").write_text(MAPPING)

    def do(name, rows, mapping=MAPPING, **options):
        text = "u,y\n" + "\n".join(f"{a!r},{b!r}" for a, b in zip(u[rows].tolist(), y[rows].tolist()))
        (tmp_path / f"{name}.csv").write_text(text)
        (tmp_path / "map.toml").write_text(mapping)
        out = tmp_path / f"{name}.run.sqlite"
        import_file(
            tmp_path / f"{name}.csv", format="csv", out=out, mapping=str(tmp_path / "map.toml"), **options
        )
        return load_run(out)

    return do


@pytest.mark.long("takes a second")
def test_a_model_of_the_parts_is_that_of_the_whole_record(part):
    whole, first = part("whole", slice(None)), part("first", slice(CUT), wire="P1")
    second = part("second", slice(CUT, None), continues=first.path)
    assert (second.info.initial, second.info.wire) == ("continued", "P1")
    of_whole, of_parts = identify(whole, "positive"), identify([first, second], "positive")
    assert [rows.left_out for rows in of_parts.rows] == [{}, {}]
    assert of_parts.model.fit["rms"] < 0.02 * np.ptp(whole["position"])
    predicted = np.concatenate(simulate_runs(of_whole.model, [first, second]))
    np.testing.assert_allclose(predicted, simulate_runs(of_whole.model, [whole])[0], atol=1e-9)


def test_parts_that_no_model_was_made_from_share_one_zero(part):
    model = identify(part("whole", slice(None)), "positive").model
    first = part("first", slice(CUT))
    second = part("second", slice(CUT, None), continues=first.path)
    found = verify(model, [first, second]).runs
    assert found[0].offset_kind == "fitted"
    assert found[1].offset == found[0].offset


def test_a_part_whose_predecessor_is_missing_has_no_known_start(part):
    first = part("first", slice(CUT))
    second = part("second", slice(CUT, 90), continues=first.path)
    third = part("third", slice(90, None), continues=second.path)
    known = [np.isfinite(y) for y in simulate_runs(identify(first, "positive").model, [first, third])]
    assert known[0].all()
    assert not known[1][:5].any()


def test_wrong_predecessors_are_refused(part, tmp_path):
    first = part("first", slice(CUT), wire="P1")
    with pytest.raises(UsageError, match="Give the part before it"):
        part("again", slice(CUT), continues=first.path)
    with pytest.raises(UsageError, match="is of wire 'P1', not of 'P2'"):
        part("second", slice(CUT, None), continues=first.path, wire="P2")
    with pytest.raises(DataError, match="Parts of one record need the same units"):
        part("second", slice(CUT, None), MAPPING.replace('"um"', '"nm"'), continues=first.path)


@pytest.mark.long("takes three seconds")
def test_a_quantity_without_unit_is_printed_without_one(part, tmp_path, capsys):
    from smarig.cli import run

    mapping = MAPPING.replace('"um"', '"1"').replace('"V"', '"1"').replace('initial = "negative"\n', "")
    whole, half = part("whole", slice(5, None), mapping), part("half", slice(30, 90), mapping)
    model = str(tmp_path / "m.model.json")
    assert run(["identify", str(whole.path), "--surface", "positive", "-o", model]) == 0
    assert run(["verify", model, str(half.path)]) == 0
    assert run(["diagnose", model, "--train", str(whole.path), "-o", str(tmp_path / "d")]) == 0
    assert run(["verify", model, str(part("other", slice(None)).path)]) != 0
    printed = capsys.readouterr()
    text = printed.out + printed.err
    assert "without unit" in text
    assert not re.findall(r"\d 1\b|'1'", text)


@pytest.mark.parametrize(("clock", "began"), [("goes on", 3.0), ("starts again", None)])
def test_a_part_of_the_rows_of_a_file_states_when_the_clock_of_the_file_began(tmp_path, clock, began):
    u, y = _record()
    t = 3.0 + 0.5 * np.arange(u.size)
    if clock == "starts again":
        t[40:] -= t[40]
    rows = "\n".join(f"{a!r},{b!r},{c!r}" for a, b, c in zip(t.tolist(), u.tolist(), y.tolist()))
    (tmp_path / "whole.csv").write_text(f"t,u,y\n{rows}\n")
    part = MAPPING.replace('steps = "rows"', "") + f"[rows]\nfirst = 61\nlast = {u.size}\n"
    part = part.replace("[columns]", '[time]\ncolumn = "t"\nunit = "s"\n[columns]')
    (tmp_path / "part.toml").write_text(part)
    mapping, out = str(tmp_path / "part.toml"), tmp_path / "part.run.sqlite"
    import_file(tmp_path / "whole.csv", format="csv", mapping=mapping, out=out, t0=100.0)
    (record,) = input_records([load_run(out)])
    assert record.began == (None if began is None else began + 100.0)
