"""Layouts of the artefacts that several rooms share: motion, segments, features."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.errors import InputError
from miburi.motion import Motion, Skeleton

Path = str | os.PathLike[str]
Segment = tuple[str, int, int]
"""A piece of a take: its name, start (inclusive) and end (exclusive) frame."""


def _same(a: Skeleton, b: Skeleton) -> bool:
    return (
        a.joints == b.joints
        and np.array_equal(a.parents, b.parents)
        and np.array_equal(a.offsets, b.offsets)
        and np.array_equal(a.end_offsets, b.end_offsets)
    )


def write_motions(
    path: Path, motions: Mapping[str, Motion], recordings: Mapping[str, str], made_from: Mapping[str, str]
) -> None:
    """Write takes (name → motion) with the recording that each was read from."""
    with store.create(path, "motion", made_from) as file:
        skeletons, takes = file.create_group("skeletons"), file.create_group("takes")
        known: dict[str, Skeleton] = {}
        for take in sorted(motions):
            motion = motions[take]
            s = motion.skeleton
            name = next((n for n, k in known.items() if _same(k, s)), None)
            if name is None:
                base = (s.name or "skeleton").replace("/", "_")
                name = base if base not in known else f"{base}.{len(known)}"
                known[name] = s
                group = skeletons.create_group(name)
                store.put(group, "joints", list(s.joints))
                store.put(group, "parents", s.parents)
                store.put(group, "offsets", s.offsets)
                store.put(group, "ends", s.ends)
                store.put(group, "end_offsets", s.end_offsets)
            group = takes.create_group(take)
            store.put(group, "root", motion.root.astype(np.float32))
            store.put(group, "rotations", motion.rotations.astype(np.float32))
            if motion.translations is not None:
                store.put(group, "translations", motion.translations.astype(np.float32))
            if motion.angles is not None:
                store.put(group, "angles", motion.angles.astype(np.float32))
            group.attrs["fps"] = motion.fps
            group.attrs["skeleton"] = name
            group.attrs["recording"] = recordings.get(take, "")


def read_motions(path: Path, takes: Sequence[str] | None = None) -> dict[str, Motion]:
    """Read takes (all, or those named), in the order of their names.

    Raises
    ------
    InputError
        The file is no motion artefact, is damaged, or lacks a take.
    """
    motions: dict[str, Motion] = {}
    with store.open_checked(path, "motion") as file:
        skeletons: dict[str, Skeleton] = {}
        for name, group in file["skeletons"].items():
            ends, end_offsets = store.get(group, "ends", (None,)), store.get(group, "end_offsets", (None, 3))
            joints = tuple(store.get_strings(group, "joints"))
            j = len(joints)
            parents, offsets = store.get(group, "parents", (j,)), store.get(group, "offsets", (j, 3))
            skeletons[name] = Skeleton(joints, parents, offsets, name, ends, end_offsets)
        for take in sorted(file["takes"]) if takes is None else takes:
            if take not in file["takes"]:
                raise InputError(f"{path}: there is no take {take!r}")
            group = file["takes"][take]
            skeleton = skeletons[group.attrs["skeleton"]]
            root = store.get(group, "root", (None, 3))
            t, j = len(root), len(skeleton)
            motions[take] = Motion(
                skeleton,
                float(group.attrs["fps"]),
                root,
                store.get(group, "rotations", (t, j, 4)),
                store.get(group, "translations", (t, j, 3)) if "translations" in group else None,
                store.get(group, "angles", (t, 3 * j)) if "angles" in group else None,
                take,
            )
    return motions


def read_lengths(path: Path) -> dict[str, tuple[int, float]]:
    """Frames and frames per second of each take of a motion artefact, without reading its motions."""
    with store.open_checked(path, "motion") as file:
        takes = file["takes"]
        return {
            take: (int(takes[take]["root"].shape[0]), float(takes[take].attrs["fps"]))
            for take in sorted(takes)
        }


def write_segments(
    path: Path,
    pieces: Mapping[str, NDArray[np.int64]],
    methods: Mapping[str, str],
    parameters: Mapping[str, Any],
    made_from: Mapping[str, str],
) -> None:
    """Write the pieces of takes, (S, 2) start (inclusive) and end (exclusive) frames, and how each was cut."""
    with store.create(path, "segments", made_from) as file:
        takes = file.create_group("takes")
        for take in sorted(pieces):
            spans = np.asarray(pieces[take], dtype=np.int64).reshape(-1, 2)
            group = takes.create_group(take)
            store.put(group, "starts", spans[:, 0])
            store.put(group, "ends", spans[:, 1])
            group.attrs["method"] = methods[take]
            group.attrs["parameters"] = json.dumps(dict(parameters), sort_keys=True)


def read_segments(path: Path) -> list[Segment]:
    """Read all pieces of all takes, by take and start."""
    with store.open_checked(path, "segments") as file:
        return [
            (take, int(start), int(end))
            for take in sorted(file["takes"])
            for start, end in zip(
                store.get(file["takes"][take], "starts", (None,)),
                store.get(file["takes"][take], "ends", (None,)),
                strict=True,
            )
        ]


def write_features(
    path: Path,
    features: Mapping[str, NDArray[np.float32]],
    segments: Sequence[Segment],
    fps: Mapping[str, float],
    made_from: Mapping[str, str],
) -> None:
    """Write the 42 values of every frame of takes, and their segments."""
    with store.create(path, "features", made_from) as file:
        takes = file.create_group("takes")
        for take in sorted(features):
            group = takes.create_group(take)
            store.put(group, "x", np.asarray(features[take], dtype=np.float32))
            group.attrs["fps"] = fps[take]
        group = file.create_group("segments")
        store.put(group, "take", [s[0] for s in segments])
        store.put(group, "start", np.array([s[1] for s in segments], dtype=np.int64))
        store.put(group, "end", np.array([s[2] for s in segments], dtype=np.int64))


def read_features(path: Path) -> tuple[dict[str, NDArray[np.float32]], list[Segment], dict[str, float]]:
    """Read features (take → (T, 42) float32), segments and frames per second of each take."""
    with store.open_checked(path, "features") as file:
        takes = {take: store.get(file["takes"][take], "x", (None, 42)) for take in sorted(file["takes"])}
        fps = {take: float(file["takes"][take].attrs["fps"]) for take in takes}
        group = file["segments"]
        names = store.get_strings(group, "take")
        start, end = store.get(group, "start", (len(names),)), store.get(group, "end", (len(names),))
        segments = [(n, int(a), int(b)) for n, a, b in zip(names, start, end, strict=True)]
    return takes, segments, fps
