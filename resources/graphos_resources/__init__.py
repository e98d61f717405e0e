"""Data of the program: icons, style, lessons, labs, the camera table and translations."""
