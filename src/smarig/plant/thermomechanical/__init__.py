"""Thermomechanical wires: Brinson's constitutive model, heat balance in joules, and the mechanisms that load them."""
