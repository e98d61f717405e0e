"""The workflow tabs, one per step."""
