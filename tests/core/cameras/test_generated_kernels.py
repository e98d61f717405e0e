"""The compiled kernels are what the generator writes from the equations of the models, byte for byte."""

import pytest

from graphos_core.cameras import camera_models
from graphos_core.cameras.generator import FOLDER, kernel_source

GENERATED = [name for name, model in camera_models().items() if model.equations is not None]


@pytest.mark.parametrize("name", GENERATED)
def test_generating_again_gives_the_same_file(name):
    pytest.importorskip("sympy", reason="SymPy, a tool of development, is not installed")
    path = FOLDER / f"{name}_kernels.py"
    assert path.read_bytes() == kernel_source(camera_models()[name]).encode(), (
        "run: python -m graphos_core.cameras.generator"
    )


def test_no_kernel_is_left_over():
    assert {path.stem.removesuffix("_kernels") for path in FOLDER.glob("*_kernels.py")} == set(GENERATED)
