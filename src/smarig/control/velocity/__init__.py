"""Velocity feedback (thesis §8.2): controllers from velocity error to input."""
