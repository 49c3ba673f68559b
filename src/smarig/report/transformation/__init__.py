"""Sections and figures of the page of transformation temperatures."""
