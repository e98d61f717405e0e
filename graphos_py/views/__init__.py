"""Views of results: images, matches, clouds, plots, tables and scenes."""
