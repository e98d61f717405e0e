"""Pure functions on arrays: rotation, epipolar geometry, triangulation, similarity."""
