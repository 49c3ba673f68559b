"""Choosing the next experiment: expected information per minute of rig time (§9.2)."""

from smarig.identification.adaptive.chooser import informed as informed
