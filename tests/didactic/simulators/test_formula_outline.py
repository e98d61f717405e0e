"""Formulas with live numbers look as if they were typeset anew."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from graphos_didactic.formula_outline import SIZE, formula_outline, load_typesetter, typesetter_loaded


@pytest.mark.parametrize(
    "tex",
    [
        r"r_1 = \dfrac{0.80\cdot60}{0.75\cdot23.1 + 0.20\cdot60} = 1.58",
        r"\sqrt{2}\cdot\dfrac{10.4}{3.95}\cdot x_{12}^{345} - 6.78\,\mathrm{mm}",
        r"a\hspace{0.5}b = 17",
        r"\mathbf{C} = \sigma^2\,(\mathbf{A}^T\mathbf{A})^{-1}",
    ],
)
def test_exchanged_digits_equal_a_new_typesetting(tex: str) -> None:
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    found = formula_outline(tex)
    font = FontProperties(family="DejaVu Sans", size=SIZE)
    vertices, codes = text_to_path.get_text_path(font, f"${tex}$", ismath=True)
    np.testing.assert_array_equal(found.codes, codes)
    np.testing.assert_allclose(found.vertices, vertices, atol=1e-9)
    width, _, _ = text_to_path.get_text_width_height_descent(f"${tex}$", font, ismath=True)
    assert found.width == pytest.approx(width)
    assert found.ascent > 0


def test_what_is_not_mathtext_is_refused() -> None:
    with pytest.raises(ValueError, match="frac"):
        formula_outline(r"\frac{1}")


def test_formulas_can_be_set_in_several_threads() -> None:
    load_typesetter()
    assert typesetter_loaded()
    with ThreadPoolExecutor(4) as pool:
        found = list(
            pool.map(lambda i: formula_outline(rf"\frac{{a}}{{b_{{{'x' * i}}}}} = {i}"), range(1, 25))
        )
    assert all(outline.width > 0 for outline in found)
