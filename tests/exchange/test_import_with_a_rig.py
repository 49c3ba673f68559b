"""Foreign column names together with a rig's heating model give the same run as smarig's own names."""

import numpy as np
import pytest

import smarig
from smarig.core.errors import UsageError
from smarig.exchange import export_run, import_file

MAPPING = """
name = "mine"
summary = "The twin's export under other names."
source = "made in this test"

[time]
column = "clock"

[input]
channel = "current_A"
quantity = "current"
unit = "A"

[output]
quantity = "displacement"
unit = "mm"

[columns]
current_A = { column = "amps", unit = "A" }
position = { column = "reach", unit = "mm" }
"""


@pytest.fixture
def exported(tmp_path):
    run = smarig.run(
        "first_order_descending",
        rig="one_wire_twin",
        out=tmp_path / "f.run.sqlite",
        partition_K=(0.0, 30.0, 60.0, 120.0, 174.1),
    )
    export_run(run, to="csv", out=tmp_path / "f.csv")
    lines = (tmp_path / "f.csv").read_text(encoding="utf-8").splitlines()
    head = lines[0].split(",")
    keep = [head.index(name) for name in ("time_s", "current_A", "position_mm")]
    rows = [",".join(line.split(",")[k] for k in keep) for line in lines[1:]]
    (tmp_path / "mine.csv").write_text("\n".join(["clock,amps,reach", *rows]), encoding="utf-8")
    return run, tmp_path


@pytest.mark.long("takes a second")
def test_a_mapping_and_a_rig_give_temperatures_and_steps(exported):
    run, folder = exported
    mapping = folder / "mine.toml"
    mapping.write_text(MAPPING, encoding="utf-8")
    out = folder / "mine.run.sqlite"
    import_file(folder / "mine.csv", format="csv", mapping=str(mapping), rig="one_wire_twin", out=out)
    mine = smarig.load_run(out)
    assert mine.input_unit == "K"
    assert np.max(np.abs(mine["input"] - run["input"])) < 0.5
    found, asked = mine.points()[0], run.points()[0]
    assert abs(len(found) - len(asked)) <= 1
    result = smarig.identify(mine, surface="constant")
    assert result.data.curves == 4


def test_a_rig_does_not_fit_data_without_current(tmp_path, shared_data):
    source = shared_data / "sma_cycles" / "cycles.txt"
    with pytest.raises(UsageError, match="leave it out"):
        import_file(
            source, format="csv", mapping="sma_cycles", rig="one_wire_twin", out=tmp_path / "c.run.sqlite"
        )
