"""The roles algorithms play in the five rooms, and the exact signature of each role.

An algorithm is declared with ``@algorithm(stage=…, role=…)`` (see `graphos_core.registry`) and must be callable as
its role's protocol says; the pipeline drives any algorithm of a role by this signature alone. Every function is
pure: it prints nothing, reads no settings, and gives the same result for the same inputs, parameters and
``run.seed``, whatever ``run.threads`` is.

========================  =====================  =========================================================
stage                     role                   protocol
========================  =====================  =========================================================
preprocessing             analysis               `Analysis`, figures of all photos to verdicts; not a step of the pipeline
preprocessing             undistortion           `Undistortion`, one camera: how its photos are resampled
preprocessing             filter                 `Filter`, one photo; filters form a chain
features                  detector               `Detector`, one photo
features                  pairs                  `PairSelector`, all photos: which pairs are matched
features                  matcher                `Matcher`, one pair: candidate matches
features                  verification           `Verification`, one pair: verified matches
features                  thinning               `Thinning`, one pair: the verified matches that are kept
features                  tracks                 `TrackBuilder`, all pairs
adjustment                orientation            `Orientation`, tracks to oriented block
adjustment                georeferencing         `Georeferencing`, oriented block to the object frame
adjustment                bundle                 `BundleAdjustment`, block and what is known to adjusted block
dense                     depth                  `DepthEstimation`, adjusted block and photos to depth maps
dense                     fusion                 `Fusion`, depth maps to cloud
quality                   registration           `Registration`, cloud to reference
quality                   comparison             `Comparison`, cloud against reference
========================  =====================  =========================================================
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from graphos_core.data import (
    Adjustment,
    Array,
    Block,
    Camera,
    Candidates,
    Cloud,
    DepthMap,
    Features,
    Georeference,
    Known,
    Mesh,
    PairMatches,
    PairSelection,
    PhotoSet,
    Tracks,
    record,
)
from graphos_core.geometry.similarity import Similarity
from graphos_core.preprocessing.analyser import SetVerdict
from graphos_core.preprocessing.analyser_figures import PhotoFigures
from graphos_core.run import Run

if TYPE_CHECKING:
    from graphos_core.preprocessing.undistortion import Resampling

MaskReader = Callable[[int], Array | None]
"""Reads the mask of photo i: bool (h, w), True where something may be measured; None: everywhere."""

Reader = Callable[[int], Array]
"""Reads photo i, upright, as uint8 (h, w) or (h, w, 3) RGB; 16 bit and preprocessing already applied."""


@record
class ComparisonResult:
    """Distances of a cloud from a reference.

    Attributes
    ----------
    distances : float64 (n,)
        Signed distance of each cloud point, positive on the outside (along the reference normal), in `unit`.
    statistics : dict of str to float
        ``count, mean, std, rmse, median, nmad, q68, q95`` (quantiles of the absolute distance), in `unit`.
    unit : str
    definition : str
        How distances were taken, in one sentence.
    """

    distances: Array
    statistics: dict[str, float]
    unit: str
    definition: str


class Analysis(Protocol):
    """Figures of every photo of a set (`graphos_core.preprocessing.analyser_figures`) to a verdict on the set."""

    def __call__(self, figures: Sequence[PhotoFigures], params: Any, *, run: Run) -> SetVerdict: ...


class Undistortion(Protocol):
    """Calibrated camera of photos as taken to the way their undistorted ones are made; None leaves them as they are."""

    def __call__(self, camera: Camera, params: Any, *, run: Run) -> Resampling | None: ...


class Filter(Protocol):
    """Image in, image out: uint8 or uint16 (h, w), (h, w, 3) RGB or (h, w, n) to uint8 (h, w) or (h, w, 3)."""

    def __call__(self, image: Array, params: Any, *, run: Run) -> Array: ...


class Detector(Protocol):
    """Grey photo uint8 (h, w), and the colour one for `Features.colour`, to features.

    `mask` is bool (h, w), True where points may be; None: everywhere. An algorithm that has the keyword ``name: str``
    is also handed the name of the photo.
    """

    def __call__(
        self, grey: Array, colour: Array, params: Any, *, run: Run, mask: Array | None = None
    ) -> Features: ...


class PairSelector(Protocol):
    """Photos and their features to the pairs that are matched."""

    def __call__(
        self, photos: PhotoSet, features: Sequence[Features], params: Any, *, run: Run
    ) -> PairSelection: ...


class Matcher(Protocol):
    """Features of two photos to candidate matches.

    An algorithm that has the keyword ``given: GivenPair | None`` is also handed the orientation of both photos in the one
    given with the project, one with the keyword ``names: tuple[str, str]`` their names.
    """

    def __call__(self, a: Features, b: Features, params: Any, *, run: Run) -> Candidates: ...


class Verification(Protocol):
    """Candidate matches of a pair to verified ones. `index` is (a, b), `cameras` the camera of each photo."""

    def __call__(
        self,
        index: tuple[int, int],
        a: Features,
        b: Features,
        candidates: Candidates,
        cameras: tuple[Camera, Camera],
        params: Any,
        *,
        run: Run,
    ) -> PairMatches: ...


class Thinning(Protocol):
    """Verified matches of a pair to those that are kept; `ratio` and `matches` stay parallel.

    An algorithm that has the keyword ``cameras: tuple[Camera, Camera] | None`` is also handed the cameras of the pair.
    """

    def __call__(
        self, pair: PairMatches, a: Features, b: Features, params: Any, *, run: Run
    ) -> PairMatches: ...


class TrackBuilder(Protocol):
    """Features of all photos and all verified pairs to tracks."""

    def __call__(
        self, features: Sequence[Features], pairs: Sequence[PairMatches], params: Any, *, run: Run
    ) -> Tracks: ...


class Orientation(Protocol):
    """Photos, tracks and verified pairs to an oriented block (not yet finally adjusted).

    An algorithm that has the keyword ``given: Block | None`` is also handed the orientation kept with the project.
    """

    def __call__(
        self, photos: PhotoSet, tracks: Tracks, pairs: Sequence[PairMatches], params: Any, *, run: Run
    ) -> Block: ...


class Georeferencing(Protocol):
    """Oriented block and what is known of the object to the block in its frame; unchanged when nothing is known."""

    def __call__(
        self, block: Block, known: Known, params: Any, *, run: Run
    ) -> tuple[Block, Georeference]: ...


class BundleAdjustment(Protocol):
    """Block and what is known of the object to adjusted block with statistics."""

    def __call__(self, block: Block, known: Known, params: Any, *, run: Run) -> Adjustment: ...


class DepthEstimation(Protocol):
    """Adjusted block and a reader of its photos to consistent depth maps, one per photo that has neighbours.

    An algorithm that has the keyword ``mask: MaskReader | None`` is also handed the masks.
    """

    def __call__(self, block: Block, read: Reader, params: Any, *, run: Run) -> tuple[DepthMap, ...]: ...


class Fusion(Protocol):
    """Depth maps of a block and a reader of its photos (for the colours) to one cloud in the block's frame."""

    def __call__(
        self, block: Block, maps: Sequence[DepthMap], read: Reader, params: Any, *, run: Run
    ) -> Cloud: ...


class Registration(Protocol):
    """Cloud, reference and, where known, a first similarity ``reference_from_cloud`` to a better one."""

    def __call__(
        self, cloud: Cloud, reference: Cloud | Mesh, initial: Similarity | None, params: Any, *, run: Run
    ) -> Similarity: ...


class Comparison(Protocol):
    """Cloud against a reference in the same frame: signed distances and their statistics."""

    def __call__(
        self, cloud: Cloud, reference: Cloud | Mesh, params: Any, *, run: Run
    ) -> ComparisonResult: ...
