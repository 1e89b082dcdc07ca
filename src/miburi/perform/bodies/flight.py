"""Bodies in the air: the centre of mass falls freely, the angular momentum stays what it was."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from miburi.motion import Floats
from miburi.perform.bodies.people import JOINTS, Person, skeleton
from miburi.perform.bodies.score import GRAVITY, Flight, Score

if TYPE_CHECKING:
    from miburi.perform.bodies.body import Body

# Shares of the body's mass (Winter 2009, table 4.1) at the middle between two joints, or at one.
_MASSES = (
    ("Hips", "Spine", 0.142), ("Spine1", "Neck", 0.355), ("Head", "Head", 0.081),
    ("LeftArm", "LeftForeArm", 0.028), ("LeftForeArm", "LeftHand", 0.022),
    ("RightArm", "RightForeArm", 0.028), ("RightForeArm", "RightHand", 0.022),
    ("LeftUpLeg", "LeftLeg", 0.1), ("LeftLeg", "LeftFoot", 0.0465), ("LeftFoot", "LeftToeBase", 0.0145),
    ("RightUpLeg", "RightLeg", 0.1), ("RightLeg", "RightFoot", 0.0465), ("RightFoot", "RightToeBase", 0.0145),
)  # fmt: skip
_OWN = 0.015  # of the body's mass · height²: what the segments' own extent adds to the inertia
_STEPS = 60.0  # samples a second
_SLOW = 0.08  # seconds: quicker moves of the limbs do not move the root


class Path(NamedTuple):
    """Root (3) and turn (3) over a flight, as one curve of six."""

    start: float
    end: float
    curve: CubicSpline

    def at(self, t: Floats) -> tuple[Floats, Floats]:
        """Root and turn at times (T,): (T, 3) metres, (T, 3) degrees."""
        both = self.curve(t)
        return both[:, :3], both[:, 3:]


def balance(who: Person, body: Body) -> tuple[Floats, Floats]:
    """Centre of mass (T, 3) and inertia for each axis (T, 3), in the frame of the pelvis, mass 1."""
    s = skeleton(who)
    place = {"Hips": np.zeros_like(body.root)}
    for j, joint in enumerate(JOINTS[1:], 1):
        parent = JOINTS[s.parents[j]]
        place[joint] = place[parent] + body.world[parent] @ s.offsets[j]
    points = np.stack([0.5 * (place[a] + place[b]) for a, b, _ in _MASSES], axis=1)
    mass = np.array([m for _, _, m in _MASSES])
    mass = mass / mass.sum()
    local = np.einsum("tji,tpj->tpi", body.world["Hips"], points)
    middle = np.einsum("p,tpi->ti", mass, local)
    square = (local - middle[:, None]) ** 2
    about = np.stack([square[:, :, [1, 2]], square[:, :, [0, 2]], square[:, :, [0, 1]]], axis=2).sum(3)
    return middle, np.einsum("p,tpi->ti", mass, about) + _OWN * who.height**2 * np.array([0.5, 0.12, 0.5])


def path(b: Score, flight: Flight, pose: Callable[[Floats], Body]) -> Path:
    """Root and turn of a flight; the keys at both ends take over its speeds.

    The keys say where root and turn begin and end. In between the centre of mass moves on a parabola, and the body
    turns about its main axis as fast as its inertia lets it.
    """
    start, end = flight
    t = np.linspace(start, end, max(9, int((end - start) * _STEPS)))
    keys = {
        track: [next(i for i, k in enumerate(b.tracks[track]) if k.t == at) for at in flight]
        for track in ("pelvis", "turn")
    }
    whence, whither = (np.array(b.tracks["turn"][i].value) for i in keys["turn"])
    body = pose(t)
    middle, inertia = (
        gaussian_filter1d(x, _SLOW / (t[1] - t[0]), axis=0, mode="nearest") for x in balance(b.who, body)
    )
    axis = [1, 0, 2][int(np.abs(whither - whence).argmax())]  # yaw is about y
    rate = 1.0 / inertia[:, axis]
    share = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))])
    share /= share[-1]
    turn = whence + share[:, None] * (whither - whence)
    hips = Rotation.from_euler("YXZ", turn, degrees=True).as_matrix()
    off = -np.einsum("tij,tj->ti", hips, middle)
    u = ((t - start) / (end - start))[:, None]
    off = off - (1 - u) * off[0] - u * off[-1]
    a, z = (b.tracks["pelvis"][i] for i in keys["pelvis"])
    fall = (1 - u) * np.array(a.value) + u * np.array(z.value)
    fall[:, 1] += 0.5 * GRAVITY * (t - start) * (end - t)
    curve = CubicSpline(t, np.hstack([fall + off, turn]), bc_type="natural")
    for track, columns in (("pelvis", slice(0, 3)), ("turn", slice(3, 6))):
        for i, at in zip(keys[track], flight, strict=True):
            speed = tuple(curve(at, 1)[columns].tolist())
            b.tracks[track][i] = b.tracks[track][i]._replace(speed=speed)
    return Path(start, end, curve)
