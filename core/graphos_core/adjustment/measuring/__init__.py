"""Measuring points in photos: sub-pixel places of targets, and where a point is to be found in the other photos."""
