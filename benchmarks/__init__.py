"""Benchmarks, one module per question. Each has ``run(quick) -> dict``."""
