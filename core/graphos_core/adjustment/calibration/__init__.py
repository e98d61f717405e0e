"""Calibration of a camera with photos of a test field: targets are detected, photos oriented, everything adjusted."""
