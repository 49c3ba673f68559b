"""Instruments: what bytes mean, what moves them, one driver per instrument."""
