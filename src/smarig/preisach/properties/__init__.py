"""Chapter 4: what the measure of a hysteresis implies. Strips, continuity, positivity, monotone branches."""

from smarig.preisach.properties.report import Change, Properties, properties

__all__ = ["Change", "Properties", "properties"]
