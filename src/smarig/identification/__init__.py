"""Identification from recorded runs: surfaces, positive densities, FORC data, calibration, verification."""
