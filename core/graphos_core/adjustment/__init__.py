"""Room 3, adjustment: where the cameras stood, where the points are, and how well that is known."""
