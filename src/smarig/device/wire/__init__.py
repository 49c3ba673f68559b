"""Bytes and what they mean: registers, framings, checksums. No input or output, no physics, no rig."""
