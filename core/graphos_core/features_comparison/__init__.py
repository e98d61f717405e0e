"""Comparing detectors, descriptors and matchers on somebody's own photos: one row per algorithm and parameter set.

`variants` says what is compared, `compare` measures it, `disturbances` changes a photo in known ways, `measures` counts
against a known homography, `figures`, `page` and `tables` show it.
"""
