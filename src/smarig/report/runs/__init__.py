"""Pages of recorded runs: a single run, and a comparison of runs."""
