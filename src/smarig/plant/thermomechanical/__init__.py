"""Thermomechanical wires: Brinson's constitutive model, heat balance in joules, and the mechanisms that load them.

The model of Boyd and Lagoudas at constant stress is a generalised play and so a Preisach operator itself; a wire that
is none was wanted.
"""
