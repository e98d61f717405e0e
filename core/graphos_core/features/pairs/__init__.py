"""Ways to choose the pairs of photos that are matched, one per file."""
