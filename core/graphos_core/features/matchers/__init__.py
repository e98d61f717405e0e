"""Matchers, one per file: the features of two photos to candidate matches."""
