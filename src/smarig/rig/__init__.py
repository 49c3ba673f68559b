"""What carries commands out: the Rig seam, its limits, and the software twin behind it."""
