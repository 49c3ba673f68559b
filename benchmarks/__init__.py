"""Measured ratios and recoveries, one module per question: ``run(quick) -> dict``."""
