"""Distances of a cloud from a reference, one way of measuring them per file."""
