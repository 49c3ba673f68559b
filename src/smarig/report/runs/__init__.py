"""Sections and figures of recorded runs, alone and compared."""
