"""Pictures of many bands (multispectral, near infrared, thermal) made visible: which bands become red, green and blue."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array


def shown_bands(count: int) -> tuple[int, int, int]:
    """Return which bands (0 is the first) are shown as red, green and blue.

    Three bands are red, green and blue; four are those and one more, usually near infrared. More are taken in the order
    of growing wavelength, as multispectral cameras and satellites store them (blue, green, red, red edge, near
    infrared …): the third, second and first. Of two the second counts twice.
    """
    if count == 2:
        return (0, 1, 1)
    return (2, 1, 0) if count > 4 else (0, 1, 2)


def visible(image: Array) -> Array:
    """Return a picture as people see it: grey stays grey, three bands stay RGB, others become false colours.

    Parameters
    ----------
    image : uint8 or uint16 (h, w), (h, w, 3) or (h, w, n)

    Returns
    -------
    uint8 or uint16 (h, w) or (h, w, 3)
    """
    if image.ndim == 2 or image.shape[2] == 3:
        return image
    if image.shape[2] == 1:
        return np.ascontiguousarray(image[:, :, 0])
    return np.ascontiguousarray(image[:, :, shown_bands(image.shape[2])])
