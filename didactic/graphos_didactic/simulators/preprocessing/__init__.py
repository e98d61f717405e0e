"""Simulators of the preprocessing room."""
