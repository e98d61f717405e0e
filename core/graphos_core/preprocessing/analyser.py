r"""Smart image analyser: what is good or bad about the photos of a set, and whether enhancing them would pay.

GRAPHOS looked at the dispersion of hue and saturation in HSV, one score per image, and compared the median over the
set with a threshold. Both coefficients are computed and shown here. Measured on simulated series and real sets
(`benchmarks/analyser.py`, table in the documentation) they do not tell whether enhancement brings more verified
matches; the number of strong spots does, so that is the score unless `AnalyserParams.score` says otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, record
from graphos_core.params import About, Params
from graphos_core.preprocessing.analyser_figures import (
    PhotoFigures,
    blur_by_reblurring,
    colour_dispersion,
    exposure,
    fingerprint,
    local_contrast,
    noise_level,
    strong_spots,
    working_copy,
)
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

LESSON = "preprocessing/analyser"
ENHANCEMENT = ("clahe",)
"""The filters that are recommended: of those measured they gained most and lost least."""


class AnalyserParams(Params):
    """Parameters of the analyser."""

    score: Annotated[
        Literal["spots", "colour"],
        About(
            label="Score",
            help="What is compared with the threshold.",
            effect="Strong spots: how much a detector can find. Colour dispersion: the mean of the dispersion "
            "coefficients of hue and saturation, as GRAPHOS proposed; measured, it predicts little.",
            choices={"spots": "strong spots", "colour": "colour dispersion"},
            learn=LESSON,
            level="student",
        ),
    ] = "spots"
    threshold: Annotated[
        int,
        About(
            label="Threshold",
            symbol="n_0",
            unit="spots",
            low=100,
            high=1_000_000,
            step=1000,
            help="A set whose median photo has fewer strong spots is recommended for enhancement.",
            effect="Higher: more sets are enhanced. Lower: only sets with hardly any texture.",
            learn=LESSON,
            level="student",
        ),
    ] = 15_300
    colour_threshold: Annotated[
        float,
        About(
            label="Threshold of colour dispersion",
            low=0.0,
            high=5.0,
            step=0.05,
            help="The same for the score by colour dispersion.",
            effect="Higher: more sets are enhanced. Lower: fewer.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.5
    blur: Annotated[
        float,
        About(
            label="Blur remarked",
            low=0.0,
            high=1.0,
            step=0.05,
            help="A photo whose blur is larger by so much than the median of its set is remarked.",
            effect="Higher: only bad photos are remarked. Lower: also slightly softer ones.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.08
    clipped: Annotated[
        float,
        About(
            label="Clipped pixels remarked",
            unit="%",
            low=0.0,
            high=100.0,
            step=1.0,
            help="A photo of which more pixels are black or white is remarked.",
            effect="Higher: only strongly over- or underexposed photos. Lower: also small highlights.",
            learn=LESSON,
            level="expert",
        ),
    ] = 5.0
    noise: Annotated[
        float,
        About(
            label="Noise remarked",
            unit="grey level",
            low=0.0,
            high=100.0,
            step=0.5,
            help="A photo with a larger standard deviation of noise is remarked.",
            effect="Higher: only very noisy photos. Lower: also usual ones.",
            learn=LESSON,
            level="expert",
        ),
    ] = 6.0
    likeness: Annotated[
        float,
        About(
            label="Likeness of duplicates",
            low=0.5,
            high=1.0,
            step=0.001,
            help="Two photos whose reduced copies correlate so much show the same from the same place.",
            effect="Higher: only identical photos. Lower: also neighbours with a short base.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.995


@record
class PhotoVerdict:
    """What the analyser says about one photo.

    Attributes
    ----------
    figures : PhotoFigures
    score : float
        Strong spots, or the colour dispersion.
    verdict : {"good", "weak", "bad"}
        Good: nothing to remark. Weak: its score is below the threshold. Bad: a remark concerns the photo itself
        (blurred, wrongly exposed, noisy).
    remarks : tuple of str
        Sentences with the numbers behind them.
    """

    figures: PhotoFigures
    score: float
    verdict: str
    remarks: tuple[str, ...] = ()


@record
class SetVerdict:
    """What the analyser says about a set of photos.

    Attributes
    ----------
    photos : tuple of PhotoVerdict
        In the order given.
    score, threshold : float
        Median over the set, and what it is compared with.
    unit : str
        Of both.
    enhance : bool
        Whether enhancement is recommended.
    filters : tuple of str
        The filters recommended, names of algorithms of the role ``filter``; empty when the photos are to be left
        alone.
    reason : str
        Why, with the numbers.
    duplicates : tuple of (int, int, float)
        Pairs of photos that show the same from the same place, with their correlation.
    """

    photos: tuple[PhotoVerdict, ...]
    score: float
    threshold: float
    unit: str
    enhance: bool
    filters: tuple[str, ...]
    reason: str
    duplicates: tuple[tuple[int, int, float], ...] = ()


def measure_photo(image: Array) -> PhotoFigures:
    """Measure one photo; texture and colour on a working copy, sharpness and noise in full resolution.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    """
    image = eight_bit(image)
    grey = luma(image)
    small = working_copy(grey)
    blur, motion, direction = blur_by_reblurring(grey)
    black, white, mean = exposure(small)
    hue, saturation = colour_dispersion(image)
    return PhotoFigures(
        width=image.shape[1],
        height=image.shape[0],
        spots=strong_spots(small),
        contrast=local_contrast(small),
        hue_dispersion=hue,
        saturation_dispersion=saturation,
        blur=blur,
        motion=motion,
        motion_direction=direction,
        black=black,
        white=white,
        mean=mean,
        noise=noise_level(grey),
        fingerprint=fingerprint(small),
    )


@algorithm(
    stage="preprocessing",
    role="analysis",
    name="analyser",
    label="Smart image analyser",
    source="González-Aguilera et al. 2018, GRAPHOS (dispersion of hue and saturation, median over the set); Lowe 2004, "
    "section 3 (strong spots); Crete et al. 2007 (blur); Immerkær 1996 (noise)",
    learn=LESSON,
)
def judge_set(figures: Sequence[PhotoFigures], params: AnalyserParams, *, run: Run) -> SetVerdict:
    """Judge every photo of a set, and the set as a whole by its median, whether enhancing would bring more matches.

    Parameters
    ----------
    figures : sequence of PhotoFigures
        At least one.
    params : AnalyserParams
    run : Run
    """
    by_spots = params.score == "spots"
    threshold = float(params.threshold) if by_spots else params.colour_threshold
    scores = [_score(one, by_spots) for one in figures]
    middle = float(np.median(scores))
    usual_blur = float(np.median([one.blur for one in figures]))
    photos = tuple(
        _judge(one, score, threshold, usual_blur, params) for one, score in zip(figures, scores, strict=True)
    )
    enhance = middle < threshold
    return SetVerdict(
        photos=photos,
        score=middle,
        threshold=threshold,
        unit="spots" if by_spots else "",
        enhance=enhance,
        filters=ENHANCEMENT if enhance else (),
        reason=_reason(middle, threshold, by_spots, enhance),
        duplicates=duplicates(figures, params.likeness),
    )


def _score(figures: PhotoFigures, by_spots: bool) -> float:
    if by_spots:
        return float(figures.spots)
    return (figures.hue_dispersion + figures.saturation_dispersion) / 2.0


def _reason(score: float, threshold: float, by_spots: bool, enhance: bool) -> Text:
    if by_spots:
        template = (
            "The median photo has {score:.0f} strong spots, fewer than {threshold:.0f}: a detector finds fewer points "
            "than it could use, so raising local contrast brings more verified matches."
            if enhance
            else "The median photo has {score:.0f} strong spots, at least {threshold:.0f}: there is enough texture, "
            "and raising local contrast would lift noise more than structure."
        )
    else:
        template = (
            "The median colour dispersion is {score:.2f}, less than {threshold:.2f}: the photos are poor in colours."
            if enhance
            else "The median colour dispersion is {score:.2f}, at least {threshold:.2f}: the photos are rich in colours."
        )
    return Text(template, score=score, threshold=threshold)


def _judge(
    figures: PhotoFigures, score: float, threshold: float, usual_blur: float, params: AnalyserParams
) -> PhotoVerdict:
    faults = []
    if figures.blur > usual_blur + params.blur:
        if figures.motion > params.blur:
            faults.append(Text(
                "Motion blur: {blur:.2f} where the set has {usual:.2f}, mostly along {angle:.0f}°.",
                blur=figures.blur, usual=usual_blur, angle=np.degrees(figures.motion_direction),
            ))  # fmt: skip
        else:
            faults.append(Text("Out of focus: blur {blur:.2f} where the set has {usual:.2f}.",
                               blur=figures.blur, usual=usual_blur))  # fmt: skip
    if 100.0 * figures.white > params.clipped:
        faults.append(
            Text("Overexposed: {share:.1f} % of the pixels are white.", share=100.0 * figures.white)
        )
    if 100.0 * figures.black > params.clipped:
        faults.append(
            Text("Underexposed: {share:.1f} % of the pixels are black.", share=100.0 * figures.black)
        )
    if figures.noise > params.noise:
        faults.append(Text("Noisy: standard deviation {noise:.1f} grey levels.", noise=figures.noise))
    remarks = list(faults)
    weak = score < threshold
    if weak and params.score == "spots":
        remarks.append(Text("Little texture: {score:.0f} strong spots.", score=score))
    elif weak:
        remarks.append(Text("Little colour: dispersion {score:.2f}.", score=score))
    verdict = "bad" if faults else "weak" if weak else "good"
    return PhotoVerdict(figures=figures, score=score, verdict=verdict, remarks=tuple(remarks))


def duplicates(figures: Sequence[PhotoFigures], likeness: float) -> tuple[tuple[int, int, float], ...]:
    """Return pairs of photos of one size whose fingerprints correlate at least so much, most alike first.

    Photos of one colour have no fingerprint and are never duplicates.
    """
    prints = np.stack([one.fingerprint for one in figures])
    alike = prints @ prints.T
    pairs = [
        (int(i), int(j), float(alike[i, j]))
        for i, j in np.argwhere(np.triu(alike >= likeness, 1))
        if (figures[i].width, figures[i].height) == (figures[j].width, figures[j].height)
    ]
    return tuple(sorted(pairs, key=lambda pair: (-pair[2], pair[0], pair[1])))
