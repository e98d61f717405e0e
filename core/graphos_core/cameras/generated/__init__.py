"""Kernels written by `graphos_core.cameras.generator` from the formulas of the models; never edited by hand."""
