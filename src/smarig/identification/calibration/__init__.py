"""Calibration of the wire's constants: heat loss, time constant, resistances."""
