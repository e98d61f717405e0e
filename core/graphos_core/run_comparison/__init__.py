"""The parts of a run comparison; `graphos_core.compare_runs.compare` puts them together."""
