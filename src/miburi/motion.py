"""Skeleton and Motion: the two nouns that every room speaks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError

Floats = NDArray[np.float64]


def _frozen(values: ArrayLike, dtype: Any, shape: tuple[int, ...]) -> NDArray[Any]:
    """A read-only array of the given type and shape (−1 in `shape`: any length)."""
    array = np.array(values, dtype=dtype).reshape(shape)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of joints at rest.

    A joint sits at the proximal end of its bone; the tails of the outermost bones (fingertips, toes, the top of
    the head) are `ends`.

    Parameters
    ----------
    joints
        J names, parents before children.
    parents : (J,) int32
        Index of each joint's parent, −1 for the root.
    offsets : (J, 3) float64
        Metres from the parent's joint, in the parent's frame.
    name
        Whose skeleton it is.
    ends : (E,) int32
        The joint that each end belongs to.
    end_offsets : (E, 3) float64
        Metres from that joint, in its frame.

    Raises
    ------
    InputError
        A name stands twice, a child stands before its parent, or a number is not finite.
    """

    joints: tuple[str, ...]
    parents: NDArray[np.int32]
    offsets: Floats
    name: str = ""
    ends: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    end_offsets: Floats = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        joints = tuple(str(j) for j in self.joints)
        n = len(joints)
        for attribute, dtype, shape in (
            ("parents", np.int32, (-1,)),
            ("offsets", np.float64, (-1, 3)),
            ("ends", np.int32, (-1,)),
            ("end_offsets", np.float64, (-1, 3)),
        ):
            object.__setattr__(self, attribute, _frozen(getattr(self, attribute), dtype, shape))
        object.__setattr__(self, "joints", joints)
        who = f"skeleton {self.name!r}"
        if len(self.parents) != n or len(self.offsets) != n or n == 0:
            raise InputError(
                f"{who}: {n} joints, {len(self.parents)} parents and {len(self.offsets)} offsets, "
                "expected as many of each"
            )
        if len(self.ends) != len(self.end_offsets):
            raise InputError(f"{who}: {len(self.ends)} ends and {len(self.end_offsets)} end offsets")
        if len(set(joints)) != n:
            twice = sorted({j for j in joints if joints.count(j) > 1})
            raise InputError(f"{who}: joint {twice[0]!r} stands twice")
        if self.parents[0] != -1 or any(not 0 <= p < i for i, p in enumerate(self.parents[1:].tolist(), 1)):
            raise InputError(f"{who}: the root must come first and every joint after its parent")
        if len(self.ends) and not (self.ends.min() >= 0 and self.ends.max() < n):
            raise InputError(f"{who}: an end belongs to no joint")
        if not (np.isfinite(self.offsets).all() and np.isfinite(self.end_offsets).all()):
            raise InputError(f"{who}: an offset is not finite")

    def __len__(self) -> int:
        return len(self.joints)

    def index(self, name: str) -> int:
        """The index of a joint.

        Raises
        ------
        InputError
            There is no such joint; the sentence lists those that there are.
        """
        try:
            return self.joints.index(name)
        except ValueError:
            raise InputError(
                f"skeleton {self.name!r} has no joint {name!r}; it has {', '.join(self.joints)}"
            ) from None


@dataclass(frozen=True, eq=False)
class Motion:
    """A take: a skeleton that moves.

    Parameters
    ----------
    skeleton
        Whose joints move.
    fps
        Frames per second.
    root : (T, 3) float64
        Where the root is, metres, Y up (added to the root's offset).
    rotations : (T, J, 4) float64
        Unit quaternions x y z w of each joint in its parent's frame.
    translations : (T, J, 3) float64, optional
        Metres by which each joint moves against its parent, added to its offset (root: zeros). Only for recordings
        whose joints do so.
    angles : (T, 48) float64, optional
        Hands: degrees, joint-major, Z X Y ([H], M = 48).
    name
        The take's name.

    Raises
    ------
    InputError
        Shapes do not fit, a number is not finite, or `fps` is not positive.
    """

    skeleton: Skeleton
    fps: float
    root: Floats
    rotations: Floats
    translations: Floats | None = None
    angles: Floats | None = None
    name: str = ""

    def __post_init__(self) -> None:
        j = len(self.skeleton)
        try:
            object.__setattr__(self, "root", _frozen(self.root, np.float64, (-1, 3)))
            t = len(self.root)
            object.__setattr__(self, "rotations", _frozen(self.rotations, np.float64, (t, j, 4)))
            if self.translations is not None:
                object.__setattr__(self, "translations", _frozen(self.translations, np.float64, (t, j, 3)))
            if self.angles is not None:
                object.__setattr__(self, "angles", _frozen(self.angles, np.float64, (t, 3 * j)))
        except ValueError as error:
            raise InputError(
                f"take {self.name!r}: arrays of {j} joints do not fit together: {error}"
            ) from None
        object.__setattr__(self, "fps", float(self.fps))
        if not (np.isfinite(self.fps) and self.fps > 0):
            raise InputError(f"take {self.name!r}: {self.fps} frames per second, expected a positive number")
        for values in (self.root, self.rotations, self.translations, self.angles):
            if values is not None and not np.isfinite(values).all():
                frame = int(np.argwhere(~np.isfinite(values))[0][0])
                raise InputError(f"take {self.name!r}, frame {frame}: a number is not finite")

    def __len__(self) -> int:
        return len(self.root)

    def __getitem__(self, frames: slice) -> Motion:
        """The motion of a range of frames."""
        if not isinstance(frames, slice):
            raise TypeError("a Motion is cut by a slice of frames")
        return replace(
            self,
            root=self.root[frames],
            rotations=self.rotations[frames],
            translations=None if self.translations is None else self.translations[frames],
            angles=None if self.angles is None else self.angles[frames],
        )

    def positions(self) -> Floats:
        """Where the joints are.

        Returns
        -------
        (T, J, 3) float64
            Metres, Y up.
        """
        from miburi.kinematics import forward  # a noun's one verb; the room below holds the algorithm

        return forward(self)[0]

    def end_positions(self) -> Floats:
        """Where the ends (fingertips, toes, the top of the head) are: (T, E, 3) float64, metres, Y up."""
        from miburi.kinematics import ends

        return ends(self)
