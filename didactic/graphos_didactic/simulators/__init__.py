"""The interactive simulators, by room."""
