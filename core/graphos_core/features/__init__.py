"""Room 2, features: points that can be recognised, and which of them are the same."""
