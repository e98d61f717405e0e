"""Bringing a cloud into the frame of a reference, one way per file."""
