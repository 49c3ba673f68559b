"""Chapter 4: what the measure of a hysteresis implies. Strips, continuity, positivity, monotone branches."""

from smarig.theory.properties.summary import OutputChange, Properties, properties

__all__ = ["OutputChange", "Properties", "properties"]
