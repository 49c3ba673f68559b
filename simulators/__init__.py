"""The rig's two devices in software, behind real bytes: what a bench without hardware talks to.

The rules are in firmware_protocol/README.md; the physics is the twin's (``smarig.rig.specimen``).
"""
