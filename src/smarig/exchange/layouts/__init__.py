"""Layouts in which a row is not an instant: long tables, pairs of columns, logs, JSON."""
