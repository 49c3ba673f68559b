"""Model comparison on runs with a commanded current: hypotheses become predictions of positions and channels."""
