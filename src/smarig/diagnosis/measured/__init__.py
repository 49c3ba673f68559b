"""Diagnosis of records with a measured input: hypotheses compared by their errors on blocks left out of the fit."""
