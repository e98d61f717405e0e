"""Detectors, one per file: a photo to its features."""
