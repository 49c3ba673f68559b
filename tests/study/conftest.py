"""Fixtures of the tests of studies."""

from diagnosis.comparison.few_readings import few_readings

__all__ = ["few_readings"]
