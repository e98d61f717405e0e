"""The pages of the adjustment tab: space, findings, calibration, residuals, reliability, iterations, comparison."""
