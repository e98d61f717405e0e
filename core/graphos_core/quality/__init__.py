"""Room 5, quality control: how good the model is, against a reference or by its own figures."""
