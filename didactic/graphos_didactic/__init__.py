"""What teaches: scenes, simulators, explanations and labs; runs without any window."""
