"""Preisach hysteresis: the operator, the measures it runs on, what can be said of them. Knows no wire, no data."""
