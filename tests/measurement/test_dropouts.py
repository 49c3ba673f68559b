"""Rows that read exactly 0 are drop-outs where the input is elsewhere, and readings where it passes 0."""

import numpy as np

from smarig.measurement import dropouts

COOLING = np.round(np.linspace(60.0, -60.0, 2401), 1)  # 0.1 K or nothing from row to row


def test_a_drop_out_near_zero_would_be_a_reversal_and_is_found():
    u = COOLING.copy()
    lost = [1230, 1231, 1300, 2000]  # −1.5, −1.5, −5 and −40 °C
    u[lost] = 0.0
    assert np.flatnonzero(dropouts(u)).tolist() == lost


def test_passing_zero_is_no_drop_out():
    assert not dropouts(COOLING).any()
    field = 100 * np.cos(np.linspace(0, 4 * np.pi, 401))
    field[np.abs(field) < 1e-9] = 0.0
    assert (field == 0).any()
    assert not dropouts(field).any()
