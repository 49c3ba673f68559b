"""Runs and campaigns of a folder in order, each a process of its own, started by a worker that outlives the console."""
