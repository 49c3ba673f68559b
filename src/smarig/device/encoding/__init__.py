"""Encoding of exchanges: registers, framings and check words, without input or output."""
