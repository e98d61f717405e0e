"""The page is self-contained, complete, escaped, and its pictures say what they show."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest

from graphos_core.data import Adjustment, Georeference
from graphos_core.report.adjustment_sections import adjustment_section, points_section, residuals_section
from graphos_core.report.build import adjustment_parts
from graphos_core.report.camera_pictures import correlation_picture, profile_picture, uncertainty_picture
from graphos_core.report.camera_sections import cameras_section
from graphos_core.report.control_sections import check_section, control_section, known_section
from graphos_core.report.explanations import explanations
from graphos_core.report.page import Page, Paragraph, Picture, Pictures, Problem, Section, Table
from graphos_core.report.photo_pictures import cell_means
from graphos_core.report.photo_sections import photos_section
from graphos_core.report.plot import nice_ticks, tick_labels
from graphos_core.report.reliability_sections import reliability_section
from graphos_core.report.statement import statement
from graphos_core.report.values import plain

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def sections(adjusted: Adjustment, placed: Georeference) -> dict[str, Section]:
    report = plain(adjustment_parts(adjusted, placed))
    report["statement"] = statement(report)
    made = (
        adjustment_section(report, adjusted), cameras_section(report, adjusted), photos_section(report, adjusted),
        points_section(report, adjusted), residuals_section(report, adjusted), reliability_section(report, adjusted),
        control_section(report, adjusted, None), check_section(report), known_section(report),
    )  # fmt: skip
    return {s.anchor: s for s in made if s is not None}


def page_of(sections: dict[str, Section]) -> str:
    problems = [
        Problem("error", "The scale is free & easy.", "Give <one> distance.", "adjustment/rank-defects")
    ]
    return Page("A <project>", "made today", problems, [("6", "photos")], tuple(sections.values())).html()


def test_every_part_of_the_issue_has_its_section(sections: dict[str, Section]) -> None:
    assert list(sections) == [
        "adjustment", "cameras", "photos", "points", "residuals", "reliability", "control", "check", "known",
    ]  # fmt: skip
    assert all(explanations([s.learn]) for s in sections.values()), "each section is explained by a lesson"


def test_page_is_self_contained_escaped_and_puts_problems_first(sections: dict[str, Section]) -> None:
    page = page_of(sections)
    assert "The scale is free &amp; easy." in page
    assert "<project>" not in page
    assert "&lt;Simulated&gt; &amp; tested" in page
    assert page.index("The scale is free") < page.index('id="adjustment"')
    for outside in ('src="http', 'href="http', "<script", "url(http"):
        assert outside not in page


def test_every_link_has_its_target(sections: dict[str, Section]) -> None:
    page = page_of(sections)
    targets = set(re.findall(r'id="([^"]+)"', page))
    links = set(re.findall(r'href="#([^"]+)"', page))
    assert links
    assert links <= targets


def test_pictures_are_wellformed_and_accessible(sections: dict[str, Section]) -> None:
    found = re.findall(r"<svg .*?</svg>", page_of(sections), re.DOTALL)
    assert len(found) > 10
    for markup in found:
        root = ElementTree.fromstring(markup)
        assert root.get("role") == "img"
        assert root.get("aria-label") == root.findtext(f"{SVG}title")
        assert "nan" not in markup
        assert all(path.get("d") for path in root.iter(f"{SVG}path"))


def test_definitions_stand_beside_sigma0_and_rms(sections: dict[str, Section]) -> None:
    table = next(p for p in sections["adjustment"].parts if isinstance(p, Table))
    defined = {str(row[0]): str(row[2]) for row in table.rows}
    assert "√(vᵀPv / r)" in defined["sigma0, without unit"]
    assert "per coordinate" in defined["Reprojection RMS"]


def test_not_significant_parameters_are_named(sections: dict[str, Section]) -> None:
    lines = [p.text for p in sections["cameras"].parts if isinstance(p, Paragraph)]
    assert any("radial distortion 2" in line for line in lines)


def test_mean_residual_vectors_show_an_injected_ring(adjusted: Adjustment) -> None:
    camera = adjusted.block.cameras[0]
    rng = np.random.default_rng(5)
    xy = rng.uniform([0, 0], [1599, 1199], (20000, 2))
    outward = (xy - [799.5, 599.5]) / 1000.0
    centres, means, chance = cell_means(camera, xy, outward + rng.normal(0.0, 0.5, xy.shape))
    error = means - (centres - [800.0, 600.0]) / 1000.0
    assert len(means) == 16 * 12
    assert np.sqrt((error**2).sum(axis=1).mean()) < 1.5 * np.median(chance)


def test_photos_are_drawn_worst_first(adjusted: Adjustment, placed: Georeference) -> None:
    worse = adjusted.residuals.copy()
    worse[adjusted.block.obs_photo == 4] *= 3.0
    bad = replace(adjusted, residuals=worse)
    section = photos_section(plain(adjustment_parts(bad, placed)), bad)
    pictures = next(p for p in section.parts if isinstance(p, Pictures))
    assert pictures.pictures[0].caption.startswith("photo 4")


def test_camera_pictures_take_the_documented_keys() -> None:
    curve = {"focal_px": 1500.0, "shift_px": [0.0, 1.0, -3.0], "sigma_px": [0.0, 0.1, 0.5]}
    profile = {"radius_px": [0, 500, 1000], "gaussian": curve, "balanced": curve, "note": "n"}
    grid = {"columns_px": [0, 800], "rows_px": [0, 600], "sigma_px": [[0.1, 0.2], [None, 0.4]], "note": "n"}
    correlations = {"names": ["a", "b"], "symbols": ["a_1", "b"], "matrix": [[1.0, -0.5], [-0.5, 1.0]]}
    for picture in (
        profile_picture(profile, "c"), uncertainty_picture(grid, 1600, 1200, "c"), correlation_picture(correlations, "c"),
    ):  # fmt: skip
        assert isinstance(picture, Picture)
        assert "nan" not in ElementTree.tostring(ElementTree.fromstring(picture.svg)).decode()
    assert "−50" in correlation_picture(correlations, "c").svg


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-0.003, 0.004), (0.0, 58130.0), (-4.2, 4.2)])
def test_ticks_are_round_and_inside(low: float, high: float) -> None:
    ticks = nice_ticks(low, high, 6)
    assert low <= ticks[0]
    assert ticks[-1] <= high
    assert 3 <= len(ticks) <= 14
    assert len(set(tick_labels(ticks))) == len(ticks)
