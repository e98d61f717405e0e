"""The headless engine of GRAPHOS-Py: from photos to a measured 3D model, without any window."""

import os

from graphos_core.kernel_cache import use_kernel_cache

__version__ = "0.1.0"

# numba tries TBB first and warns when it finds an old one; OpenMP is there wherever the wheels are, and thread-safe
os.environ.setdefault("NUMBA_THREADING_LAYER_PRIORITY", "omp tbb workqueue")
use_kernel_cache()
