"""Simulators of the features room."""
