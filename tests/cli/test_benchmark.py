"""``smarig benchmark``: benchmarks are found by name, and each prints one JSON object with the documented
figures."""

import json
import sys
from importlib import import_module

import numpy as np
import pytest

from benchmarks import forward, inverse, large
from smarig.cli import run
from smarig.core.catalogue import catalogue_names
from smarig.exchange import import_file
from smarig.preisach.compiled import compiled_available


def call(capsys, *arguments):
    status = run(list(arguments))
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.long("takes three seconds")
def test_forward_reports_ratios_memory_and_agreement(capsys):
    status, out, _ = call(capsys, "benchmark", "forward", "--quick", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["relays"] == 5050
    assert 0 <= found["agreement_of_range"] <= 1e-12
    assert 0 < found["peak_memory_MB"] < 50
    assert set(found["plain_python"]) == {"measure", "table", "surface_two_c", "surface_two_e"}
    assert all(rate > 0 for kind in found["plain_python"].values() for rate in kind.values())
    if compiled_available():
        assert found["numba"]["equal_to_plain_bit_for_bit"] is True
        assert len(found["numba"]["random_walk_per_s"]) == 3
    else:
        assert found["numba"] is None


def test_inverse_reports_errors_of_both(capsys):
    status, out, _ = call(capsys, "benchmark", "inverse", "--quick", "--json")
    found = json.loads(out)
    assert status == 0
    for kind in ("measure", "table", "surface_two_c", "surface_two_e"):
        assert found[kind]["round_trip_error_of_range"] <= 1e-12
        assert found[kind]["ratio_to_brentq_on_peek"] > 0


def test_people_get_the_same_figures_as_text(capsys, monkeypatch):
    monkeypatch.setattr(inverse, "run", lambda quick: {"targets": 3, "quick": quick})
    status, out, _ = call(capsys, "benchmark", "inverse")
    assert status == 0
    assert json.loads(out) == {"targets": 3, "quick": False}


@pytest.mark.parametrize(
    ("name", "says"),
    [("forwards", "did you mean forward"), ("nonsense", "There are:"), ("generator", "No benchmark")],
)
def test_an_unknown_benchmark_is_refused_with_the_names_there_are(capsys, name, says):
    status, _, err = call(capsys, "benchmark", name)
    assert status == 2
    assert says in err
    assert "forward, " in err


def test_the_inputs_are_what_their_docstrings_say():
    """Whole range, a few thresholds crossed at a step, no two seeds alike; two hundred periods, decaying."""
    u = forward.random_walk(100_000)
    assert u.min() < -0.999
    assert u.max() > 0.999
    crossed = np.abs(np.diff(np.floor(u / forward.CELL)))
    assert 1 < crossed.mean() < 2
    assert crossed.max() <= 3
    assert np.bincount(((u + 1) * 5).astype(int).clip(0, 9)).min() > 2000
    assert not np.array_equal(u, forward.random_walk(100_000, 1))
    v = forward.decaying_sine(100_000)
    assert np.sum((v[1:] >= 0) & (v[:-1] < 0)) == 199
    assert v[:500].max() > 0.99
    assert abs(v[-1]) < 1e-3


def test_the_baseline_is_the_relays_definition():
    """Four relays by hand (3.1)."""
    measure = forward.RelayMeasure.from_arrays(
        [1.0, 2.0, 3.0, 2.0], [0.0, 0.0, 1.0, 2.0], [1.0, 10.0, 100.0, 1000.0]
    )
    u = np.array([0.0, 1.0, 2.5, 3.0, 1.5, 1.0, 0.5, 0.0])
    by_hand = [-1111.0, -1109.0, 911.0, 1111.0, -889.0, -1089.0, -1089.0, -1111.0]
    assert forward.relay_array(measure, u).tolist() == by_hand


def test_the_help_names_every_benchmark(capsys):
    status, out, _ = call(capsys, "benchmark", "--help")
    assert status == 0
    said = out.split("NAME:")[1].split(".")[0].replace("\n", " ")
    there = [n for n in catalogue_names("benchmarks") if hasattr(import_module(f"benchmarks.{n}"), "run")]
    assert [n.strip() for n in said.split(",")] == sorted(there)


def test_memory_is_that_of_the_process_alone():
    """Neither that of the benchmark, nor that of an earlier process."""
    mine = bytearray(70_000_000)  # more than `little` may have
    mine[::4096] = b"x" * len(mine[::4096])
    little, much = (
        large._measured(sys.executable, "-S", "-c", f"x = b'x' * {size}") for size in (1000, 80_000_000)
    )
    assert 70 < much["rss_MB"] - little["rss_MB"] < 100
    assert little["rss_MB"] < 60
    assert much["cpu_s"] > 0
    assert large._measured(sys.executable, "-S", "-c", "raise SystemExit('no such extra')") == {
        "said": "no such extra"
    }


def test_the_table_of_the_import_is_one_that_it_reads(tmp_path):
    large._write_table(tmp_path / "t.csv", 20_000)
    assert import_file(tmp_path / "t.csv", format="csv", out=tmp_path / "t.run.sqlite").rows == 20_000
