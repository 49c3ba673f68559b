"""Sections of closed-loop runs: tracking, regulation, velocity feedback, and their comparison."""
