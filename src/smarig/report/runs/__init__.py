"""Pages of recorded runs: one run, and runs compared."""
