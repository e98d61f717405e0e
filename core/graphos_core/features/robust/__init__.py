"""The robust search: models that fit a minimal sample, samplers, the search itself, and the choice between models."""
