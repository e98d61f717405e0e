"""Simulators of the adjustment room."""
