"""What the preprocessing tab shows."""
