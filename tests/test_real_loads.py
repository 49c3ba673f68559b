"""Models of several loads from measurements by others: a load left out is predicted, its zero included.

The limits are those of an interpolation of the recorded branches between the two neighbouring loads, in T − σ/C.
"""

import numpy as np
import pytest

from smarig.exchange import import_file
from smarig.identification import identify
from smarig.record import load_run
from smarig.replay import simulate

long = pytest.mark.long("takes ten seconds")
STRESSES = (7, 50, 100, 200, 300, 400)


@pytest.fixture
def measured(shared_data, tmp_path):
    def load(folder, name, mapping, **options):
        source = shared_data / folder / name
        if not source.is_file():
            pytest.skip(f"real data {source.name} are not in {source.parent}")
        out = tmp_path / f"{name.split('.')[0]}.run.sqlite"
        return load_run(import_file(source, format="csv", mapping=mapping, out=out, **options).run)

    return load


def rms(run, model):
    return float(np.sqrt(np.nanmean((simulate(model, run) - run["position"]) ** 2)))


@pytest.mark.long("takes five seconds", cases=("300-0.056",))
@pytest.mark.parametrize(
    ("left_out", "percent"),
    [(300, 0.056), pytest.param(200, 0.102, marks=long), pytest.param(100, 0.143, marks=long)],
)
def test_a_load_left_out_is_predicted_better_than_by_interpolating_curves(measured, left_out, percent):
    runs = {s: measured("sma_isobaric/cal_sample_2", f"{s} MPa.txt", "sma_isobaric_2") for s in STRESSES}
    found = identify([r for s, r in runs.items() if s != left_out], load_from="stress")
    assert found.load is not None
    low, high = found.load.interval
    assert low < 10.0 < high
    assert rms(runs[left_out], found.model) <= percent / 100


@long
def test_one_model_fits_six_stresses(measured):
    """A published one-model fit leaves 0.078 % strain over the six."""
    runs = [measured("sma_isobaric/cal_sample_2", f"{s} MPa.txt", "sma_isobaric_2") for s in STRESSES]
    model = identify(runs, load_from="stress").model
    assert np.sqrt(np.mean([rms(r, model) ** 2 for r in runs])) < 0.078 / 100


@pytest.mark.parametrize("stress", [100, 200])
def test_both_files_of_the_chamber_are_imported_and_repaired(measured, stress):
    run = measured("sma_chamber", f"chamber_{stress}MPa.csv", "sma_chamber", repair=True)
    dropouts = {100: 39, 200: 38}[stress]  # rows of 0.0 °C between readings that are more than 0.7 K away
    assert run.info.repairs["drop-outs"]["count"] == dropouts
    assert 0.007 < np.nanmax(run["position"]) - np.nanmin(run["position"]) < 0.009, "mm/mm"
    assert run.info.conditions["stress"]["mean"] == pytest.approx(stress, rel=0.02)
