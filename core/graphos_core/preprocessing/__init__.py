"""Room 1, preprocessing: making photos easier to match."""
