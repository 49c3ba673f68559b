"""Model comparison: hypotheses about a record compete only by predicting blocks of it that they have not seen."""
