"""Theoretical models: blocks and photos whose truth is known, for tests, the demo and lessons."""
