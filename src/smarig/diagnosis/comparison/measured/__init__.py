"""Hypotheses on records with a measured input, compared by the blocks they have not seen."""
