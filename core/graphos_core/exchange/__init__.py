"""Reading and writing other programs' formats, one file per format."""
