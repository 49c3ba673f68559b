"""Physics of the wire: heating, hysteresis, mechanics. Knows no device, no protocol, no file."""
