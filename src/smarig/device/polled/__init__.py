"""Instruments that are queried, sampled by the clock of the host so that a bench can use them."""
