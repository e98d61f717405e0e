"""The window must appear at once: importing the views costs no numba, scipy, plotting or Open3D."""

import subprocess
import sys


def test_importing_the_views_imports_nothing_slow() -> None:
    code = (
        "import sys\n"
        "from graphos_py.views import cloud_view, depth_view, image_view, match_view, plot_view, table_view\n"
        "slow = {'numba', 'scipy', 'pyqtgraph', 'matplotlib', 'open3d'} & set(sys.modules)\n"
        "assert not slow, slow\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
