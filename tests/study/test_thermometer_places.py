"""Of several temperatures, that of the specimen is the input, wherever it stands and however the others jump."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study import guess_table, mapping_draft
from study.known_data import displacements, table_of, temperatures

U = temperatures()
X = displacements(U)
T = np.arange(U.size) * 0.5
OVEN = U + 3 * np.sin(T)
SET = np.round(U, 1)


@pytest.mark.parametrize(
    "names",  # of the set-point, the surroundings and the specimen
    [
        ("Sollwert", "Temp. Ofen", "Temp. Probe"),
        ("T_set", "T_furnace", "T_specimen"),
        ("SP", "TE 02", "PV"),
        ("Temp SP", "temperature bath", "temperature (1)"),
        ("T_Soll", "T_Kammer", "T_Draht"),
        ("setpoint", "102 <Tair>", "101 <Twire>"),
    ],
)
@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
def test_the_specimen_is_the_input(names, order):
    data = [SET, OVEN, U]
    columns = {f"{names[k]} [°C]": data[k] for k in order}
    guess = guess_table(table_of(**{"time [s]": T}, **columns, **{"stroke [mm]": X}))
    assert [c.name for c in guess.of_role("input")] == [f"{names[2]} [°C]"]
    assert guess.roles[f"{names[0]} [°C]"].reason == "a set-point: it was not measured"
    assert [
        name for name in columns if f'columns = ["{names[2]} [°C]", "{name}"]' in mapping_draft(guess, "m")
    ] == [f"{names[1]} [°C]"]


@pytest.mark.parametrize("second", [OVEN, None])
def test_a_set_point_is_the_input_where_nothing_was_measured(second):
    other = {} if second is None else {"temperature [°C]": second}
    guess = guess_table(
        table_of(**{"time [s]": T, "temp. setpoint [°C]": SET}, **other, **{"stroke [mm]": X})
    )
    drive = guess.first("input")
    assert drive is not None
    assert drive.commanded == (second is None)


def test_a_long_name_says_where_a_thermometer_is(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for name, x, unit, long_name in (
            ("channel_1", OVEN, "degC", "air in the chamber"),
            ("channel_2", U, "degC", "type K welded to the wire"),
            ("gauge", X, "mm", ""),
            ("seconds", T, "s", ""),
        ):
            file[name] = x
            file[name].attrs["units"] = unit
            if long_name:
                file[name].attrs["long_name"] = long_name
    (table,) = find_tables(path)
    drive = guess_table(table).first("input")
    assert drive is not None
    assert drive.name == "channel_2"
    without = replace(table, columns=tuple(replace(c, comment="") for c in table.columns))
    assert guess_table(without).first("input").name == "channel_1"
