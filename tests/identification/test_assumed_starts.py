"""A state at the start that nobody recorded is assumed alike by identification, verification and diagnosis, and
stated with what it matters.
"""

import re
from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import driven_run
from smarig.diagnosis import diagnose
from smarig.identification import identify, verify

# The first reading lies 4 % above the lowest input; falling back to it ends the record.
INPUTS = [6.0, *np.linspace(15, 150, 30), *np.linspace(145, 0, 30)]
HALF_WAY = [40.0, 45.0, 70.0, 100.0, 120.0]


def _as_import(run, unknown=True):
    """Settled readings of others: no rig recorded the state."""
    meta = {k: v for k, v in run.meta.items() if k != "initial" or not unknown}
    return replace(run, meta={**meta, "source": "import"})


def _run(name="loop", inputs=INPUTS, unknown=True):
    return _as_import(driven_run("one_e", inputs, name=f"{name}.run.sqlite"), unknown)


def test_all_rows_of_a_run_that_starts_near_an_end_are_used():
    found = identify(_run(), "positive")
    assert found.rows[0].left_out == {}
    assert found.model.fit["rms"] == pytest.approx(
        identify(_run(unknown=False), "positive").model.fit["rms"], rel=0.2
    )
    (said,) = [w for w in found.warnings if "is not recorded" in w]
    assert said.startswith("The state at the start of loop is not recorded; negative saturation was assumed.")
    assert 'write initial = "negative" or "positive" in the mapping' in said


def test_the_error_from_the_other_saturation_is_stated():
    model = identify(_run(unknown=False), "positive").model
    assert not any("is not recorded" in w for w in model.warnings)
    judged = verify(model, _run("half.way", HALF_WAY)).runs[0]
    assert judged.settled.n == len(HALF_WAY)
    (said,) = [w for w in judged.warnings if "is not recorded" in w]
    assert "The state at the start of half.way is not recorded; negative saturation" in said
    here, other = (float(size) for size in re.findall(r"([\d.e-]+) mm", said))
    assert other > 1.1 * here


def test_a_rig_s_own_run_does_not_assume_a_state():
    run = _run()
    own = replace(run, meta={**run.meta, "source": "bench"})
    assert identify(own, "positive").rows[0].left_out["unknown memory"] > 0


def test_a_diagnosis_assumes_what_the_model_was_identified_with():
    run = _run()
    found = diagnose(identify(run, "positive").model, run)
    assert "is far from these data" not in found.text()
    assert "negative saturation was assumed" in found.text()
