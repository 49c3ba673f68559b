"""The two devices of a rig in software, behind real bytes, for a bench without hardware.

The rules are in firmware_protocol/README.md. The physics is that of the twin (``smarig.rig.specimen``).
"""
