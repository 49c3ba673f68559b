"""Resumes an interrupted run from a restored state of the wire."""
