"""Fixtures of the comparison's tests."""

from diagnosis.comparison.few_readings import few_readings

__all__ = ["few_readings"]
