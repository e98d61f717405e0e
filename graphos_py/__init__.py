"""The desktop application: the only floor that knows the screen."""
