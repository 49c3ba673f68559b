"""FORC density from scattered first-order reversal curves."""
