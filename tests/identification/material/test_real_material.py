"""Measurements by others: one constitutive model of all loads, judged in sample and on loads left out.

The limits are those of a published one-model fit (SMA-REACT, in sample 0.078 %) and of an interpolation in T − σ/C.
"""

import pytest

from smarig.exchange import import_file
from smarig.identification import identify_material
from smarig.record import load_run


@pytest.fixture
def material(shared_data, tmp_path):
    def fitted(folder, names, mapping):
        runs = []
        for k, name in enumerate(names):
            source = shared_data / folder / name
            if not source.is_file():
                pytest.skip(f"real data {source.name} are not in {source.parent}")
            out = tmp_path / f"{k}.run.sqlite"
            runs.append(load_run(import_file(source, format="csv", mapping=mapping, out=out).run))
        return identify_material(runs)

    return fitted


@pytest.mark.long("takes twenty seconds")
def test_nitihf_under_six_loads(material):
    loads = (7, 50, 100, 200, 300, 400)
    found = material("sma_isobaric/cal_sample_2", [f"{s} MPa.txt" for s in loads], "sma_isobaric_2")
    assert 100 * found.rms <= 0.078
    by_load = {round(r.record.level): 100 * r.left_out_rms for r in found.records}
    assert by_load[100] <= 0.143
    assert by_load[200] <= 0.102
    assert by_load[300] <= 0.056
    assert "modulus_martensite" in found.not_determined
    assert 60e3 < found.parameters["modulus_austenite"].value < 95e3


@pytest.mark.long("takes ten seconds")
def test_flexinol_under_three_loads(material):
    names = [f"filtered_data_{s}MPa.txt" for s in (50, 100, 150)]
    found = material("flexinol_isobaric", names, "flexinol_isobaric")
    by_load = {round(r.record.level, -1): 100 * r.left_out_rms for r in found.records}
    assert by_load[150] <= 0.10
    assert found.own_zeros
    assert found.two_parts
    assert found.parameters["slope_austenite"].value == pytest.approx(8.0, abs=1.0)
