"""Local rotations of joints from columns of Euler angles, each joint with its own order and number of
angles."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.motion import Floats


@njit
def _compose(values, columns, axes, bases, half, out):  # type: ignore[no-untyped-def]
    for t in range(values.shape[0]):
        for j in range(columns.shape[0]):
            x, y, z, w = 0.0, 0.0, 0.0, 1.0
            for k in range(columns.shape[1]):
                column = columns[j, k]
                if column < 0:
                    continue
                h = values[t, column] * half
                s, d = math.sin(h), math.cos(h)
                # q · (s e_a, d), Hamilton product with a rotation about one axis
                if axes[j, k] == 0:
                    x, y, z, w = x * d + w * s, y * d + z * s, z * d - y * s, w * d - x * s
                elif axes[j, k] == 1:
                    x, y, z, w = x * d - z * s, y * d + w * s, z * d + x * s, w * d - y * s
                else:
                    x, y, z, w = x * d + y * s, y * d - x * s, z * d + w * s, w * d - z * s
            c = bases[j]
            out[t, j, 0] = c[0, 0] * x + c[0, 1] * y + c[0, 2] * z
            out[t, j, 1] = c[1, 0] * x + c[1, 1] * y + c[1, 2] * z
            out[t, j, 2] = c[2, 0] * x + c[2, 1] * y + c[2, 2] * z
            out[t, j, 3] = w


def rotations(
    values: Floats,
    columns: NDArray[np.int64],
    axes: NDArray[np.int64],
    *,
    degrees: bool = True,
    bases: Floats | None = None,
) -> Floats:
    """Unit quaternions of joints from a table of angles.

    M of a joint is the product, from left to right, of the rotations about its axes; R = C M C⁻¹.

    Parameters
    ----------
    values : (T, C)
        Angles among other values.
    columns : (J, 3) int
        Columns of each joint's angles, −1 where it has fewer.
    axes : (J, 3) int
        0, 1, 2: about x, y, z.
    bases : (J, 3, 3), optional
        C of each joint, a rotation; absent: no change.

    Returns
    -------
    (T, J, 4) float64
        x y z w.
    """
    out = np.empty((len(values), len(columns), 4))
    half = np.pi / 360 if degrees else 0.5
    # C M C⁻¹ turns M's axis by C and leaves its angle
    c = np.tile(np.eye(3), (len(columns), 1, 1)) if bases is None else np.ascontiguousarray(bases)
    _compose(np.ascontiguousarray(values), columns, axes, c, half, out)
    return out


def zxy(quaternions: Floats) -> Floats:
    """Angles Z X Y in degrees, R = Rz Rx Ry, of unit quaternions x y z w: the inverse of `rotations`.

    Where x is ±90° y and z turn about the same axis; y is then 0.
    """
    x, y, z, w = np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0)
    # elements of Rz Rx Ry: r21 = sin x; r01, r11 hold z; r20, r22 hold y
    r21 = 2 * (y * z + x * w)
    r01, r11 = 2 * (x * y - z * w), 1 - 2 * (x * x + z * z)
    r20, r22 = 2 * (x * z - y * w), 1 - 2 * (x * x + y * y)
    r10, r00 = 2 * (x * y + z * w), 1 - 2 * (y * y + z * z)
    cosine = np.hypot(r20, r22)
    locked = cosine < 1e-8
    about_x = np.arctan2(r21, cosine)
    about_y = np.where(locked, 0.0, np.arctan2(-r20, r22))
    about_z = np.where(locked, np.arctan2(r10, r00), np.arctan2(-r01, r11))
    degrees: Floats = np.degrees(np.stack([about_z, about_x, about_y], axis=-1))
    return degrees
