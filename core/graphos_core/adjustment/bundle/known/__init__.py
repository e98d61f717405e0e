"""Observations beside image points: control coordinates, distances, positions and attitudes of photos, shapes, rigs.

Every kind is a frozen class with the same few attributes and methods, see `graphos_core.adjustment.bundle.known.group`;
`graphos_core.adjustment.bundle.known.build` makes them from a `Known` record.
"""
