"""Identification from continuous sweeps: the lag of the heating together with the hysteresis."""
