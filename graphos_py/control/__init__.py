"""The control page of the adjustment: table of points, measuring in the photos, distances; every edit can be undone."""
