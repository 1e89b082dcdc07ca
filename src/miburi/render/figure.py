"""What is seen of motions: points and bones with sizes and colours, a grid, and where the camera stands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d

from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import FINGERS, HAND
from miburi.kinematics import ends, forward
from miburi.motion import Floats, Motion, Skeleton

FIELD = float(np.radians(32.0))
"""Vertical field of view."""

_TRUNK = (0.42, 0.42, 0.45)
_LEFT = (0.86, 0.36, 0.13)
_RIGHT = (0.12, 0.38, 0.68)
_FINGERS = (
    (0.55, 0.16, 0.10),
    (0.93, 0.56, 0.16),
    (0.25, 0.56, 0.30),
    (0.15, 0.45, 0.68),
    (0.42, 0.28, 0.60),
)
_HAND_VIEW = (0.34, 0.30, 1.0)  # palm, a little from the thumb's side and from above
_STANDS_STILL = 2.5  # metres: a body that goes further is followed by the camera


class Group(NamedTuple):
    """Figures as they are drawn: N points and B bones over T frames.

    Parameters
    ----------
    points : (T, N, 3)
        Joints and ends, metres.
    owners : (N,)
        The number of the figure that each point belongs to.
    bones : (B, 2)
        Indices of the points that each bone joins.
    radii, bone_radii : (N,), (B,)
        Metres.
    colours, bone_colours : (N, 4), (B, 4)
        Red, green, blue, opacity, from 0 to 1.
    floor, cell
        Height of the grid and width of its cells, metres.
    view : (3,)
        From the figures towards the camera.
    follow : (T, 3)
        What the camera keeps up with; zeros if it stands still.
    """

    points: Floats
    owners: NDArray[np.int64]
    bones: NDArray[np.int64]
    radii: Floats
    bone_radii: Floats
    colours: Floats
    bone_colours: Floats
    floor: float
    cell: float
    view: Floats
    follow: Floats


class Camera(NamedTuple):
    """Where the camera is at each frame: `rotation` (3, 3), columns right, up, back; `places` (T, 3)
    metres."""

    rotation: Floats
    places: Floats


def is_hand(skeleton: Skeleton) -> bool:
    """Whether the skeleton has the 16 joints of `figures.HAND`."""
    return skeleton.joints == HAND.joints


def group(motions: Sequence[Motion]) -> Group:
    """Figures side by side, from the left to the right of the picture, facing the camera as the first one
    does."""
    parts = [_one(m) for m in motions]
    frames = max(len(p.points) for p in parts)
    points, bones, first, edge = [], [], 0, 0.0
    right = look(parts[0].view)[:, 0]
    away = np.cross(right, (0.0, 1.0, 0.0))
    for part in parts:
        # several stay in their places, however far they go
        own = _turned(part, parts[0].view) if len(parts) > 1 else part.points
        own = np.concatenate([own, np.repeat(own[-1:], frames - len(own), axis=0)])
        if len(parts) > 1:
            across = own @ right
            own = own + (edge - across.min()) * right - np.mean(own @ away) * away  # in one row
            own[:, :, 1] += parts[0].floor - part.floor  # on one ground
            edge += float(np.ptp(across)) + 2.0 * part.cell
        points.append(own)
        bones.append(part.bones + first)
        first += own.shape[1]
    return Group(
        np.concatenate(points, axis=1),
        np.repeat(np.arange(len(points)), [p.shape[1] for p in points]),
        np.concatenate(bones),
        np.concatenate([p.radii for p in parts]),
        np.concatenate([p.bone_radii for p in parts]),
        np.concatenate([p.colours for p in parts]),
        np.concatenate([p.bone_colours for p in parts]),
        floor=parts[0].floor,
        cell=max(p.cell for p in parts),
        view=parts[0].view,
        follow=parts[0].follow if len(parts) == 1 else np.zeros((frames, 3)),
    )


def _turned(part: Group, view: Floats) -> Floats:
    """Points of a figure that stays in its place, turned about the vertical so that it is seen from `view`
    as it was from `part.view`."""
    angle = np.arctan2(view[0], view[2]) - np.arctan2(part.view[0], part.view[2])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.asarray((part.points - part.follow[:, None]) @ turn.T)


def _one(motion: Motion) -> Group:
    """One figure."""
    skeleton = motion.skeleton
    joints = forward(motion)[0]
    points = np.concatenate([joints, ends(motion)], axis=1)
    n = len(skeleton)
    hidden = 0 if is_hand(skeleton) else _below(skeleton)
    pairs = [(int(p), j) for j, p in enumerate(skeleton.parents) if p >= hidden]
    pairs += [(int(e), n + k) for k, e in enumerate(skeleton.ends)]
    bones = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    lengths = np.linalg.norm(points[0, bones[:, 0]] - points[0, bones[:, 1]], axis=1)
    bones, lengths = bones[lengths > 1e-3], lengths[lengths > 1e-3]  # joints in one place need no bone
    hand = is_hand(skeleton)
    palette = np.array((_TRUNK, *_FINGERS) if hand else (_TRUNK, _LEFT, _RIGHT, _LEFT, _RIGHT))
    colours = palette[limbs(skeleton)]
    thickness = 0.0062 if hand else 0.019 * _height(skeleton)
    radii, bone_radii = _sizes(points.shape[1], bones, lengths, thickness)
    points[:, :hidden] = points[:, hidden : hidden + 1]  # inside the first joint that is seen
    opaque = np.ones((points.shape[1], 1))
    rgba = np.concatenate([colours, opaque], axis=1)
    tint = 0.72 * rgba + 0.28 * np.array([1.0, 1.0, 1.0, 1.0])
    return Group(
        points,
        np.zeros(points.shape[1], dtype=np.int64),
        bones,
        radii,
        bone_radii,
        rgba,
        tint[bones[:, 1]],
        floor=float(joints[:, 0, 1].min()) if hand else _floor(points, thickness),
        cell=0.02 if hand else 0.5,
        view=np.array(_HAND_VIEW) if hand else _front(motion, joints),
        follow=np.zeros((len(points), 3)) if hand else _path(joints[:, hidden], motion.fps),
    )


def _height(skeleton: Skeleton) -> float:
    """About how tall a body is, metres: 2.1 times a leg, or the longest way from the root to a leaf
    doubled."""
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    way = np.zeros(len(skeleton))
    for j, p in enumerate(skeleton.parents):
        way[j] = way[p] + lengths[j] if p >= 0 else 0.0
    try:
        known = find_joints(skeleton)
    except InputError:
        return 2.0 * float(way.max()) or 1.0
    return 2.1 * float(way[known["l_foot"]] - way[known["l_hip"]]) or 1.0


def _below(skeleton: Skeleton) -> int:
    """How many first joints only carry the waist (a root on the floor, say) and are not part of the body."""
    try:
        waist = find_joints(skeleton)["waist"]
    except InputError:
        return 0
    k = 0
    while k < waist and k + 1 < len(skeleton) and np.count_nonzero(skeleton.parents == k) == 1:
        k += 1
    return k


def _sizes(n: int, bones: NDArray[np.int64], lengths: Floats, thickness: float) -> tuple[Floats, Floats]:
    """Radii of points and bones: the figure's thickness, less where the bones are short (fingers of a
    body)."""
    longest = np.zeros(n)
    np.maximum.at(longest, bones.ravel(), np.repeat(lengths, 2))
    radii = np.clip(0.24 * longest, 0.3 * thickness, thickness)
    bone_radii = 0.62 * np.minimum(radii[bones[:, 0]], radii[bones[:, 1]])
    return radii, bone_radii


def _floor(points: Floats, thickness: float) -> float:
    """Height of the ground: below all but the lowest hundredth of the frames."""
    return float(np.quantile(points[:, :, 1].min(axis=1), 0.01)) - thickness


LIMBS = ("trunk", "left arm", "right arm", "left leg", "right leg")
"""Parts of a body."""


def limbs(skeleton: Skeleton) -> list[int]:
    """The part that each joint, then each end, belongs to.

    Of a body an index of `LIMBS`; of a hand 0 for the wrist and 1 to 5 for the fingers. All 0 where the joints'
    names say nothing.
    """
    found = [0] * len(skeleton)
    if is_hand(skeleton):
        found = [0, *(1 + FINGERS.index(j[:-1]) for j in HAND.joints[1:])]
    else:
        try:
            known = find_joints(skeleton)
        except InputError:
            known = {}
        for part, start in enumerate(("l_shoulder", "r_shoulder", "l_hip", "r_hip"), 1):
            if known:
                found[known[start]] = part
        for j, p in enumerate(skeleton.parents):
            if p >= 0 and found[p]:
                found[j] = found[p]
    return [*found, *(found[e] for e in skeleton.ends)]


def _front(motion: Motion, joints: Floats) -> Floats:
    """From the figure to a camera before it, 35° to its left and 14° up; what is before it is the mean
    over time."""
    try:
        known = find_joints(motion.skeleton)
    except InputError:
        return np.array([0.5, 0.25, 1.0])
    left = joints[:, [known["l_hip"], known["l_shoulder"]]].mean(axis=1)
    right = joints[:, [known["r_hip"], known["r_shoulder"]]].mean(axis=1)
    across = left - right
    ahead = np.stack([-across[:, 2], across[:, 0]], axis=1)  # y up: forward is across × up
    x, z = ahead.mean(axis=0)
    if np.hypot(x, z) < 1e-6:
        x, z = 0.0, 1.0
    angle = np.arctan2(x, z) + np.radians(35.0)
    return np.array([np.sin(angle), np.tan(np.radians(14.0)), np.cos(angle)])


def _path(waist: Floats, fps: float) -> Floats:
    """The waist's smoothed way over the ground, from its first frame; zeros if it stays in one place."""
    way = waist * (1.0, 0.0, 1.0)
    if np.linalg.norm(np.ptp(way, axis=0)) <= _STANDS_STILL:
        return np.zeros_like(way)
    # turned about both ends, so that who runs through them is followed at the same pace
    beyond = min(int(2.4 * fps), len(way) - 1)
    longer = np.pad(way, ((beyond, beyond), (0, 0)), mode="reflect", reflect_type="odd")
    smooth = gaussian_filter1d(longer, 0.6 * fps, axis=0, mode="nearest")[beyond : beyond + len(way)]
    return np.asarray(smooth - smooth[0])


def look(direction: ArrayLike) -> Floats:
    """Rotation (3, 3) of an upright camera that stands in this direction from what it looks at."""
    back = np.asarray(direction, dtype=np.float64)
    back = back / np.linalg.norm(back)
    right = np.cross((0.0, 1.0, 0.0), back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def framed(points: Floats, radii: Floats, rotation: Floats, aspect: float, margin: float = 1.06) -> Floats:
    """The nearest place (3,) of a camera from which all points (N, 3), with radii (N,), are in the picture.

    A point x right of and z before the picture's centre is inside if |x − cx| ≤ (D − z) tan(field / 2);
    with the largest of x + z tan and −x + z tan over all points this is two linear bounds on cx and the
    distance D; so it is for the other direction.
    """
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    seen = (points - centre) @ rotation
    tangents = np.array([aspect, 1.0]) * np.tan(FIELD / 2) / margin
    slack = radii[:, None] * np.sqrt(1 + tangents**2)
    beyond = (seen[:, :2] + seen[:, 2:] * tangents + slack).max(axis=0)
    before = (-seen[:, :2] + seen[:, 2:] * tangents + slack).max(axis=0)
    distance = float(np.max((beyond + before) / (2 * tangents)))
    return np.asarray(centre + rotation @ np.array([*((beyond - before) / 2), distance]))


def camera(figures: Group, aspect: float) -> Camera:
    """A camera from which no point of any frame is cut off.

    Parameters
    ----------
    aspect
        Width over height of the picture.
    """
    rotation = look(figures.view)
    points = (figures.points - figures.follow[:, None]).reshape(-1, 3)
    radii = np.tile(figures.radii, len(figures.points))
    return Camera(rotation, framed(points, radii, rotation, aspect) + figures.follow)


def across(figures: Group, seen_by: Camera, aspect: float) -> list[float]:
    """Where each figure's middle is in the first picture, from 0 at its left edge to 1 at its right."""
    seen = (figures.points - seen_by.places[:1, None]) @ seen_by.rotation
    middles = [
        0.5 * (seen[:, figures.owners == k].min(axis=(0, 1)) + seen[:, figures.owners == k].max(axis=(0, 1)))
        for k in range(int(figures.owners.max()) + 1)
    ]
    return [float(0.5 - 0.5 * x / (z * aspect * np.tan(FIELD / 2))) for x, _, z in middles]


def grid(figures: Group) -> Floats:
    """Lines of the grid in the ZX plane, under all the figures' way: (L, 2, 3) metres."""
    cell = figures.cell
    reach = figures.points[:, :, [0, 2]].reshape(-1, 2)
    low = np.floor(reach.min(axis=0) / cell - 1).astype(np.int64)
    high = np.ceil(reach.max(axis=0) / cell + 1).astype(np.int64)
    x = np.arange(low[0], high[0] + 1) * cell
    z = np.arange(low[1], high[1] + 1) * cell
    y = figures.floor
    along_z = [((a, y, z[0]), (a, y, z[-1])) for a in x]
    along_x = [((x[0], y, a), (x[-1], y, a)) for a in z]
    return np.array(along_z + along_x, dtype=np.float64)
