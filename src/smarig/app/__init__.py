"""Applications that combine several packages: characterise, closed loops, proposals, simulation."""
