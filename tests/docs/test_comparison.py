"""The comparison with other programs states figures of its table and properties that hold."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from benchmarks import density, forward, identify
from smarig.cli.commands.identify import command as identify_command
from smarig.cli.commands.transformation import command as transformation
from smarig.config import load_actuator, load_rig
from smarig.exchange import import_file
from smarig.identification import identify as identified
from smarig.record import load_run
from smarig.replay import simulate

ROOT = Path(__file__).parents[2]
PAGE = re.sub(r"\s+", " ", (ROOT / "docs/explanation/comparison.md").read_text(encoding="utf-8"))
MEASURED = tomllib.loads((ROOT / "docs/explanation/comparison.toml").read_text(encoding="utf-8"))

TESTED_BY = (
    ("equal to the last bit", "rig/bench/test_lock_step", "bytes_make_no_difference"),
    ("the lease of the device ends", "rig/bench/test_sudden_death", "a_killed_host_costs_time"),
    ("without a lease, limits are lower", "rig/test_limits_without_lease", ""),
    ("the memory of the wire is restored first", "runner/test_resume", "a_killed_run_ends_with_the_table"),
    (
        "what PyMeasure or QCoDeS drives",
        "device/polled/test_other_libraries",
        "their_instruments_drive_a_run",
    ),
    ("yes, with intervals", "transformation/test_intervals", "intervals_cover_the_true_temperatures"),
    (
        "nested loops from one memory",
        "preisach/test_kernel",
        "a_measure_is_its_relays_on_every_kind_of_history",
    ),
    ("causes of the model's errors", "diagnosis/test_every_effect_is_found", "an_effect_is_named"),
    ("agree within 1e-10", "identification/test_forc_density", "pmagpy_s_variforc_agrees"),
    ("only the extrema that still matter", "preisach/test_kernel", "deep_memory_is_held_and_wiped_out"),
    (
        "and what the records cannot give",
        "identification/material/test_what_records_determine",
        "constant_loads_do_not_determine",
    ),
    ("interpolated between measured loads", "test_real_loads", "a_load_left_out_is_predicted"),
)
"""Statements with the files and the beginnings of the tests that show them; no name: the whole file does."""


@pytest.mark.parametrize(("statement", "file", "begin"), TESTED_BY)
def test_a_statement_has_its_test(statement, file, begin):
    assert statement in PAGE
    assert f"def test_{begin}" in (ROOT / f"tests/{file}.py").read_text(encoding="utf-8")


def row(*cells):
    return f"| {' | '.join(cells)} |"


def percents(values):
    return [f"{value:.3f}" for value in values]


def stated_rows():
    """The rows of the page's tables, from the measured figures."""
    walk, sine, compiled = (
        MEASURED["forward"][key]
        for key in ("random_walk_per_s", "decaying_sine_per_s", "compiled_walk_per_s")
    )
    yield row(
        "smarig, plain Python",
        *(f"{low / 1e6:.1f}–{high / 1e6:.1f} million" for low, high in (walk, sine)),
        f"{MEASURED['forward']['peak_memory_MB']:.1f} MB",
    )
    yield row("smarig, compiled by numba", f"{compiled[0] / 1e6:.0f}–{compiled[1] / 1e6:.0f} million")
    for name, key in (("`forc_density`", "loess"), ("`positive`", "positive")):
        yield row(f"smarig, {name}", *(f"{mean:.4f} ± {sd:.4f}" for mean, sd in MEASURED["density"][key]))
    yield " | ".join(f"{mean:.4f} ± {sd:.4f}" for mean, sd in MEASURED["density"]["pmagpy_loess"])
    fit, left_out = MEASURED["stresses"]["one_model"], MEASURED["stresses"]["left_out"]
    pooled = float(np.sqrt(np.mean(np.square(fit))))
    yield row("smarig, `identify --load-from stress`", *percents([pooled, *fit]))
    yield " | ".join(percents(left_out[key] for key in ("100", "200", "300")))
    material, unseen = MEASURED["stresses"]["material"], MEASURED["stresses"]["material_left_out"]
    yield row("smarig, `identify --material`", *percents([np.sqrt(np.mean(np.square(material))), *material]))
    yield row("the same, this stress left out of the fit", "", "", "", *percents(unseen.values())).replace(
        "  ", " "
    )
    positive, nnls = MEASURED["identify"]["positive"], MEASURED["identify"]["nnls_cells"]
    yield f"an rms error of {positive['rms']:.4f} after {positive['seconds']:.2f} s"
    yield f"one of {nnls['rms'][0]:.4f} after {nnls['seconds'][0]:.3f} s"
    yield f"it is {nnls['rms'][1]:.3f} and {nnls['rms'][2]:.3f}"
    yield f"measured on {MEASURED['date'].day} {MEASURED['date']:%B %Y}"


def test_the_page_states_the_measured_figures():
    rows = list(stated_rows())
    assert len(rows) > 10
    assert not [text for text in rows if text not in PAGE]


def test_the_memory_of_the_forward_model():
    assert forward._peak_MB(forward.relays(), 100_000) == pytest.approx(
        MEASURED["forward"]["peak_memory_MB"], rel=0.1
    )


def test_errors_of_unseen_curves():
    """One of the five seeds: they differ by less than a tenth."""
    for method, known in (
        (identify._positive, MEASURED["identify"]["positive"]["rms"]),
        (
            identify._nnls_method(15, identify._DESIGNS["cells"]),
            MEASURED["identify"]["nnls_cells"]["rms"][0],
        ),
    ):
        assert identify._row("", method, range(1))["rms"] == pytest.approx(known, rel=0.1)


@pytest.mark.long("takes twenty seconds")
def test_errors_of_densities(monkeypatch):
    monkeypatch.setattr(density, "_pmagpy", lambda: None)
    found = {
        (r["estimator"], r["noise"]): (r["interior"], r["interior_sd"]) for r in density.run()["results"]
    }
    for name in ("loess", "positive"):
        for noise, known in zip(MEASURED["density"]["noise"], MEASURED["density"][name], strict=True):
            assert found[name, noise] == pytest.approx(known, rel=0.02)


@pytest.mark.long("takes half a minute")
def test_errors_at_six_stresses(shared_data, tmp_path):
    known = MEASURED["stresses"]
    runs = {}
    for stress in known["MPa"]:
        source = shared_data / f"sma_isobaric/cal_sample_2/{stress} MPa.txt"
        if not source.is_file():
            pytest.skip(f"real data {source.name} are not in {source.parent}")
        out = tmp_path / f"{stress}.run.sqlite"
        runs[stress] = load_run(import_file(source, format="csv", mapping="sma_isobaric_2", out=out).run)

    def percent(run, model):
        return 100 * float(np.sqrt(np.nanmean((simulate(model, run) - run["position"]) ** 2)))

    model = identified(list(runs.values()), load_from="stress").model
    assert [percent(run, model) for run in runs.values()] == pytest.approx(known["one_model"], rel=0.02)
    for stress, error in known["left_out"].items():
        others = [run for other, run in runs.items() if other != int(stress)]
        found = identified(others, load_from="stress").model
        assert percent(runs[int(stress)], found) == pytest.approx(error, rel=0.02)


def test_commands_and_options_that_the_page_names():
    assert transformation.name == "transformation"
    assert "--load-from" in {name for option in identify_command.params for name in option.opts}


def test_supplies_of_eight_makes():
    makes = tomllib.loads((ROOT / "src/smarig/device/drivers/makes.toml").read_text(encoding="utf-8"))
    assert len(makes.keys() - {"scpi"}) == 8
    assert "supplies of eight makes" in PAGE


def test_the_interpreters_and_the_system_of_the_tests():
    workflows = "".join(path.read_text(encoding="utf-8") for path in (ROOT / ".github/workflows").iterdir())
    versions = re.search(r"python: \[(.*)\]", workflows)[1].replace('"', "").split(", ")
    assert f"Tested on Linux only**, with CPython {', '.join(versions[:-1])} and {versions[-1]}" in PAGE
    assert set(re.findall(r"runs-on: (\S+)", workflows)) == {"ubuntu-latest"}
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert f"version {version.rpartition('.')[0]}," in PAGE


def test_the_default_twin_is_a_preisach_operator_and_the_other_is_none():
    kinds = {
        rig: load_actuator(load_rig(rig).actuator) for rig in ("one_wire_twin", "one_wire_thermomechanical")
    }
    assert kinds["one_wire_twin"].hysteresis is not None
    assert kinds["one_wire_twin"].thermomechanical is None
    assert kinds["one_wire_thermomechanical"].thermomechanical is not None


def test_figures_of_other_pages_are_theirs():
    diagnosis = (ROOT / "docs/explanation/diagnosis.md").read_text(encoding="utf-8")
    assert "On 55 sealed boxes" in diagnosis
    assert "No box got a false name" in diagnosis
    assert "no false name in [55 sealed boxes]" in PAGE
    benchmarks = (ROOT / "docs/reference/benchmarks.md").read_text(encoding="utf-8")
    counts = float(re.search(r"\| one_wire_thermomechanical \| ([\d.]+) \|", benchmarks)[1])
    assert f"[about {counts:.0f} counts]" in PAGE
    drivers = (ROOT / "docs/reference/drivers.md").read_text(encoding="utf-8")
    assert "not yet run on the instruments themselves" in re.sub(r"\s+", " ", drivers)
