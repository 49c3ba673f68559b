"""What the thesis proves of a Preisach operator: state space, properties, energy; and its extended models."""
