"""From a target motion and a user to a puppet log ([P]; what is modelled: `users.Habits`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS
from miburi.kinematics import trunk_frame, unit, yaw_pitch_roll
from miburi.motion import Floats, Motion
from miburi.perform.puppeteer import body, plan
from miburi.perform.puppeteer.chance import FPS, noise
from miburi.perform.puppeteer.trunk import carry, heading_and_tilt
from miburi.perform.puppeteer.users import User
from miburi.store import seed


class Seen(NamedTuple):
    """What a user sees of a clip, at 60 frames/s: where the puppet's limbs should go, and how the trunk
    turns."""

    paths: Floats
    """(T, 4, 3) metres on the puppet: hands and feet from shoulders and hips, in the trunk's frame."""
    elbows: Floats
    """(T, 4, 3) the same of elbows and knees."""
    frames: Floats
    """(T, 3, 3) the trunk in the world."""
    shown: Floats
    """(T, 4, 6) what catches the eye, in lengths of the person's leg (so a leg counts more than an arm that
    turns by the same angle): the paths in the trunk's frame, which is what has to be moved on the puppet,
    and in one that turns with the body but stays level, which is how the clip looks."""


def _at(values: Floats, clock: Floats) -> Floats:
    """Rows of values (T, …) at fractional places (N,), linear between neighbours."""
    if len(values) < 2:
        return np.repeat(values, len(clock), axis=0)
    i = np.clip(clock.astype(np.intp), 0, len(values) - 2)
    u = (clock - i).reshape(-1, *([1] * (values.ndim - 1)))
    return (1 - u) * values[i] + u * values[i + 1]


def watch(target: Motion, landmark: float) -> Seen:
    """Map a clip onto the puppet.

    Parameters
    ----------
    target
        A person.
    landmark
        0: hands go by the arm's reach from the shoulder; 1: by the trunk's size from the waist (a hand on
        the hip stays on the hip although the puppet's arms are long).
    """
    where = find_joints(target.skeleton)
    n = max(int((len(target) - 1) * FPS / target.fps), 0) + 1
    places = _at(target.positions(), np.arange(n, dtype=np.float64) * (target.fps / FPS))
    p = {name: places[:, where[name]] for name in ("waist", *BODY_JOINTS)}
    frames = trunk_frame(p["l_hip"], p["r_hip"], p["waist"], p["neck"])
    paths, elbows = np.empty((n, 4, 3)), np.empty((n, 4, 3))
    size = body.TRUNK / _length(p["neck"] - p["waist"])
    heading = heading_and_tilt(frames)[0]
    level = Rotation.from_rotvec(np.outer(heading, [0.0, 1.0, 0.0])).as_matrix()
    shown = np.empty((n, 4, 6))
    reach = [_length(p[m] - p[r]) + _length(p[e] - p[m]) for r, m, e in body.PARTS]
    for k, (root, middle, end) in enumerate(body.PARTS):
        for columns, frame in ((slice(0, 3), frames), (slice(3, 6), level)):
            shown[:, k, columns] = np.einsum("tba,tb->ta", frame, p[end] - p[root])
        from_root = shown[:, k, :3] * (body.REACH[k] / reach[k])
        from_waist = np.einsum("tba,tb->ta", frames, p[end] - p["waist"]) * size - body.ROOTS[k]
        share = (
            landmark if k < 2 else 0.0
        )  # feet are put by the legs' reach: the ground is not in the trunk's frame
        paths[:, k] = (1 - share) * from_root + share * from_waist
        elbows[:, k] = body.UPPER[k] * unit(
            np.einsum("tba,tb->ta", frames, p[middle] - p[root]), (0.0, -1.0, 0.0)
        )
    return Seen(paths, elbows, frames, shown / (np.sqrt(2) * max(reach[2:])))


def _length(vectors: Floats) -> float:
    return max(float(np.median(np.linalg.norm(vectors, axis=-1))), 1e-6)


def _within(paths: Floats) -> Floats:
    """Places (…, 4, 3) drawn in to what the limbs can reach."""
    length = np.linalg.norm(paths, axis=-1)
    drawn: Floats = paths * np.minimum(1.0, body.REACH / np.maximum(length, 1e-9))[..., None]
    return drawn


def misjudge(seen: Seen, user: User, rng: np.random.Generator) -> Floats:
    """The paths (T, 4, 3) as the user plays them: of another size, turned, shifted and without quick
    detail."""
    h = user.habits
    paths = seen.paths
    busy = int(plan.important(seen.shown, h.ignore).sum())
    harder = 1 + h.complexity * max(busy - 2, 0)
    size = np.exp(h.amplitude + h.amplitude_error * harder * rng.normal(size=4))
    turned = np.radians(h.direction_error * harder) / np.sqrt(3) * rng.normal(size=(4, 3))
    shift = h.placement_error * harder / np.sqrt(3) * rng.normal(size=(4, 3)) * body.REACH[:, None]
    smooth = gaussian_filter1d(paths, h.blur_s * FPS, axis=0, mode="nearest") if h.blur_s else paths
    centre = smooth.mean(axis=0)
    swing = np.einsum("lab,tlb->tla", Rotation.from_rotvec(turned).as_matrix(), smooth - centre)
    return _within(_felt(smooth, centre + size[:, None] * swing + shift, h.straight))


def _felt(meant: Floats, wanted: Floats, share: float) -> Floats:
    """Errors of the distance from the root lessened where a limb is meant to be straight.

    Near its stop a limb bends by 2 arccos(r) for a distance of r reaches: a foot that is a tenth too near would
    bend a straight leg by 50°, and whoever pulls a leg straight feels that it is.
    """
    there = np.linalg.norm(meant, axis=-1)
    here = np.maximum(np.linalg.norm(wanted, axis=-1), 1e-9)
    half_bend = np.sqrt(np.maximum(1 - (there / body.REACH) ** 2, 0.0))
    counts = np.clip(half_bend / 0.5, share, 1.0)
    felt: Floats = wanted * ((there + counts * (here - there)) / here)[..., None]
    return felt


def _unsteady(n: int, user: User, rng: np.random.Generator) -> Floats:
    """How hands stray from the path: (n, 4, 3) metres."""
    h = user.habits
    slow = noise(n, 12, 0.35, rng)
    quick = noise(n, 12, 0.012, rng) - noise(n, 12, 0.03, rng)
    stray: Floats = ((h.wander * slow + h.tremor * quick) / np.sqrt(3)).reshape(n, 4, 3)
    return stray


def _knocks(held: NDArray[np.bool_], user: User, rng: np.random.Generator) -> Floats:
    """Pushes (N, 4, 3), metres, when hands first take a limb and when they leave the last one.

    Taking hold pushes a limb aside for a moment; a hand that opens lets it sag.
    """
    out = np.zeros((len(held), 4, 3))
    anyone = np.flatnonzero(held.any(axis=1))
    if user.habits.knock == 0 or len(anyone) == 0:
        return out
    first, last = anyone[0], anyone[-1]
    n = min(round(0.3 * FPS), last - first + 1)
    push = rng.normal(size=(4, 3)) * user.habits.knock
    sag = 0.5 * rng.normal(size=(4, 3)) * user.habits.knock - np.array([0.0, user.habits.knock, 0.0])
    bump = np.sin(np.pi * np.arange(n) / n)[:, None, None]
    out[first : first + n] += bump * push
    n = min(round(0.2 * FPS), last - first + 1)
    out[last + 1 - n : last + 1] += (0.5 - 0.5 * np.cos(np.pi * np.arange(1, n + 1) / n))[:, None, None] * sag
    return out


def _arrange(
    paths: Floats, elbows: Floats, user: User, rng: np.random.Generator
) -> tuple[Floats, NDArray[np.bool_]]:
    """Angles (4, 4), radians, of the limbs when the log begins, and which limbs are still to be put where the
    clip begins, (4,).

    Friction holds a pose, so users put the limbs into the clip's first pose and then record, or record and then
    put them. A limb that hangs about right is left as it hangs.
    """
    h = user.habits
    ranges = np.radians(body.RANGES)
    hanging: Floats = np.clip(np.radians(h.mess) * rng.normal(size=(4, 4)), ranges[..., 0], ranges[..., 1])
    rest = -body.REACH[:, None] * np.array([0.0, 1.0, 0.0])
    off: NDArray[np.bool_] = np.linalg.norm(paths[0] - rest, axis=-1) > h.care * body.REACH
    if rng.random() >= h.arrange:
        return hanging, off
    out: Floats = hanging.copy()
    for k in np.flatnonzero(off):
        mirror = np.array([body.SIDE[k], 1.0, 1.0])
        out[k] = body.settle(
            hanging[k],
            paths[0, k] * mirror,
            elbows[0, k] * mirror,
            h.elbow,
            body.UPPER[k],
            body.LOWER[k],
            k > 1,
            ranges[k],
        )
    return out, np.zeros(4, dtype=bool)


def imitate(target: Motion, user: User, *, seed_parts: tuple[object, ...]) -> tuple[Floats, float]:
    """A simulated user plays a clip with the puppet.

    Parameters
    ----------
    target
        A person, whose skeleton `conventions.find_joints` knows.
    user
        See `users`.
    seed_parts
        What the chance of this query is named after: config seed, experiment, target, repetition …

    Returns
    -------
    angles : (N, 17) float64
        Degrees, in the order of `formats.puppet.COLUMNS`, quantised to 300/1023°.
    fps : float
        60.

    Raises
    ------
    InputError
        The target has no frames, or its skeleton lacks a joint.
    """
    if len(target) == 0:
        raise InputError(f"take {target.name!r} has no frames to imitate")
    h = user.habits
    rng = seed("imitate", user.name, *seed_parts)
    seen = watch(target, h.landmark)
    paths = misjudge(seen, user, rng)
    start, off = _arrange(paths, seen.elbows, user, rng)
    clock, held = plan.timeline(seen.shown, paths, h, rng, off)
    n = len(clock)
    wanted = np.stack([_at(paths[:, k], clock[:, k]) for k in range(4)], axis=1)
    wanted = _within(wanted + _unsteady(n, user, rng) + _knocks(held, user, rng))
    limbs = np.empty((n, 4, 4))
    for k in range(4):
        mirror = np.array([body.SIDE[k], 1.0, 1.0])
        limbs[:, k] = body.follow(
            start[k],
            wanted[:, k] * mirror,
            _at(seen.elbows[:, k], clock[:, k]) * mirror,
            held[:, k],
            round(plan.JOIN_S * FPS),
            h.elbow,
            np.radians(h.stick),
            body.UPPER[k],
            body.LOWER[k],
            k > 1,
            np.radians(body.RANGES[k]),
        )
    angles = np.empty((n, 17))
    angles[:, :14] = np.degrees(body.columns(limbs))
    busy = np.flatnonzero(held.any(axis=1))
    span = (int(busy[0]), int(busy[-1])) if len(busy) else (0, n - 1)
    angles[:, 14:] = np.degrees(yaw_pitch_roll(carry(seen.frames, clock[:, 4], span, user, rng)))
    return body.quantise(angles), FPS
