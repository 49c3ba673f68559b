"""Transformation temperatures of a wire by the tangent method."""
