"""The GP-LVMs of an index's segments: trained once, kept in an artefact of their own, used to rank."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.errors import InputError
from miburi.motion import Floats
from miburi.retrieval import gplvm
from miburi.threads import one_thread


@dataclass(frozen=True)
class Settings:
    """How models are trained and frames projected.

    Parameters
    ----------
    dims
        Latent dimensions ([P]: 2).
    frames
        So many of the drawn frames of each side are trained on and projected, evenly spaced: training takes
        their third power, projecting their square.
    iterations
        Of L-BFGS at most.
    starts
        Starts of each projection.
    """

    dims: int = 2
    frames: int = 25
    iterations: int = 100
    starts: int = 2

    def __post_init__(self) -> None:
        for name in ("dims", "frames", "iterations", "starts"):
            if getattr(self, name) < 1:
                raise InputError(f"GP-LVM: {name} is {getattr(self, name)}, expected at least 1")

    def fit(self, frames: Floats) -> gplvm.Model:
        """The model of a segment or query of which these frames were drawn."""
        return gplvm.fit(frames[_spaced(len(frames), self.frames)], self.dims, self.iterations)


def _spaced(n: int, wanted: int) -> NDArray[np.int64]:
    """At most `wanted` of n places, evenly."""
    m = min(n, wanted)
    return np.arange(m) * n // m


@dataclass(frozen=True, eq=False)
class Models:
    """A model for each of S segments.

    Parameters
    ----------
    settings
        Of training and projecting.
    frames : (N, D) float32
        The index's drawn frames, end to end.
    offsets : (S + 1,) int64
        First of a segment's rows in `frames`.
    latent : (L, dims) float64
        Latent points of the frames that each model was trained on, end to end.
    scale : (S, 2) float64
        α and σ² of each, m².
    """

    settings: Settings
    frames: NDArray[np.float32]
    offsets: NDArray[np.int64]
    latent: Floats
    scale: Floats

    @cached_property
    def _models(self) -> list[gplvm.Model]:
        places = _places(self.offsets, self.settings.frames)
        ends = np.cumsum([len(p) for p in places])
        return [
            gplvm.model(self.frames[p], self.latent[end - len(p) : end], scale)
            for p, end, scale in zip(places, ends, self.scale, strict=True)
        ]

    @cached_property
    def _rows(self) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The frames that models are trained on, end to end, and the first of each segment."""
        places = _places(self.offsets, self.settings.frames)
        starts = np.cumsum([0] + [len(p) for p in places])[:-1]
        return self.frames[np.concatenate(places)], starts

    @one_thread
    def errors(self, query: Floats) -> Floats:
        """Err of the query's frames (n, D), `settings.frames` of them, in each segment's model, (S, n), metres."""
        some = query[_spaced(len(query), self.settings.frames)]
        return np.array([gplvm.project(m, some, self.settings.starts)[1] for m in self._models])

    @one_thread
    def errors_back(self, query: Floats) -> Floats:
        """Largest Err of each segment's frames in the model of the query's (n, D), (S,), metres."""
        frames, starts = self._rows
        error = gplvm.project(self.settings.fit(query), frames, self.settings.starts)[1]
        largest: Floats = np.maximum.reduceat(error, starts)
        return largest

    def save(self, path: str | os.PathLike[str], sources: Mapping[str, str] | None = None) -> None:
        """Write the models ("miburi/gplvm"); the frames stay in the index that they were drawn for."""
        with store.create(path, "gplvm", sources) as file:
            store.put(file, "latent", self.latent)
            store.put(file, "scale", self.scale)
            for name, value in vars(self.settings).items():
                file.attrs[name] = value


def _places(offsets: NDArray[np.int64], wanted: int) -> list[NDArray[np.int64]]:
    """Rows that each segment's model is trained on."""
    return [a + _spaced(int(b - a), wanted) for a, b in pairwise(offsets)]


@one_thread
def train(frames: NDArray[np.float32], offsets: NDArray[np.int64], settings: Settings) -> Models:
    """Train the models of an index's segments (arguments as in `Models`)."""
    found = [
        gplvm.fit(frames[p], settings.dims, settings.iterations) for p in _places(offsets, settings.frames)
    ]
    return Models(
        settings,
        frames,
        offsets,
        np.concatenate([m.latent for m in found]),
        np.array([m.scale for m in found]),
    )


def open_models(
    path: str | os.PathLike[str], frames: NDArray[np.float32], offsets: NDArray[np.int64]
) -> Models:
    """Read models that `Models.save` wrote, of the index whose drawn frames these are.

    Raises
    ------
    InputError
        The file is missing or damaged, or its models are of another index.
    """
    with store.open_checked(path, "gplvm") as file:
        try:
            settings = Settings(**{name: int(file.attrs[name]) for name in vars(Settings())})
        except KeyError:
            raise InputError(
                f"{path}: an attribute is missing, expected {', '.join(vars(Settings()))}"
            ) from None
        rows = sum(len(p) for p in _places(offsets, settings.frames))
        return Models(
            settings,
            frames,
            offsets,
            store.get(file, "latent", (rows, settings.dims)),
            store.get(file, "scale", (len(offsets) - 1, 2)),
        )
