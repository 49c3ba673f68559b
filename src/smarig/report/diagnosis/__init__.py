"""Sections and figures of a diagnosis: the verdict in words, tables, residuals, gain."""
