"""Checks of the values of columns: failed readings, jumps, wraps, drift, and the order of time."""
