"""Consequences of the measure of a hysteresis (thesis ch. 4): strips, continuity, positivity, monotone branches."""

from smarig.theory.properties.summary import OutputChange, Properties, properties

__all__ = ["OutputChange", "Properties", "properties"]
