"""Sections, tables and figures of identified models."""
