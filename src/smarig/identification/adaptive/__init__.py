"""The choice of the next holds by expected information per minute of rig time (§9.2)."""

from smarig.identification.adaptive.informed_choice import informed_choice as informed_choice
