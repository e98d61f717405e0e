"""The headless engine of GRAPHOS-Py: from photos to a measured 3D model, without any window."""

__version__ = "0.1.0"
