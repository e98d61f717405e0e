"""The converter: cameras and orientations between this program's files and those of others."""
