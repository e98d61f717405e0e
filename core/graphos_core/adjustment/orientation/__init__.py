"""Initial orientation: from tracks to an oriented block."""
