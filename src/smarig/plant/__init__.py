"""Physics of the wire: heating, plant, effects, stress. Knows no device, no protocol, no file."""
