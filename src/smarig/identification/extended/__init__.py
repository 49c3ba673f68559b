"""Identification of the extensions of thesis §3.5, and the test that says whether one is needed."""
