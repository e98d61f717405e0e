"""What the residuals and cofactors say: tests, reliability, significance, variance components, diagnosis in words."""
