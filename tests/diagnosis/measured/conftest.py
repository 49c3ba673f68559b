"""Fixtures of the tests of records with a measured input."""

from diagnosis.comparison.few_readings import few_readings

__all__ = ["few_readings"]
