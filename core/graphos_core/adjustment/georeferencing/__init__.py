"""Georeferencing: from model units to metres."""
