"""Identification of the extended models of thesis §3.5, and the test whether one is needed."""
