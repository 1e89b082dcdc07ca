"""The index of segments and the ranking of its segments for a query ([P])."""

from __future__ import annotations

import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi import store
from miburi.compiled import njit
from miburi.errors import InputError
from miburi.motion import Floats
from miburi.retrieval import dtw, latent, nearest, subspace
from miburi.retrieval.jvh import bhattacharyya, jvh
from miburi.retrieval.ranking import Ranking, ranking

_PLAIN = ("mean pose", "SM(PCA)", "MSM", "DSPM(PCA)")
_LATENT = ("SM(GP-LVM)", "DSPM(GP-LVM)")
_FEW = 20  # beyond this part of the segments, all are ranked as fast as the first
_MEASURES = ("DTW", *_PLAIN, *_LATENT, *(f"{name}+Jvh" for name in _PLAIN[1:]))


def measures() -> tuple[str, ...]:
    """Names of the measures that `Index.rank` knows. All are distances: smaller is nearer."""
    return _MEASURES


def _draw(x: Floats, samples: int | None, name: bytes) -> Floats:
    """K frames at random without repeats, in time's order; where there are fewer, all, evenly repeated."""
    n = len(x)
    if samples is None:
        return x
    if n <= samples:
        # copies change no maximum and keep the samples of all segments in one array
        return x[np.arange(samples) * n // samples]
    return x[_selected(n, samples, zlib.crc32(name))]


@njit
def _selected(n, samples, seed):  # type: ignore[no-untyped-def]
    """Some of n indices, each set of so many equally likely, ascending (Knuth's algorithm S).

    In compiled code, because numpy's generators take as long to make as the bounds of a whole query. The generator of
    compiled functions in this thread begins anew.
    """
    np.random.seed(seed)  # noqa: NPY002 (numba has no other that starts as quickly)
    chosen, count = np.empty(samples, dtype=np.int64), 0
    for i in range(n):
        if np.random.random() * (n - i) < samples - count:  # noqa: NPY002
            chosen[count] = i
            count += 1
    return chosen


def _checked(x: ArrayLike, width: int | None, what: str) -> Floats:
    frames = np.asarray(x, dtype=np.float64)
    if frames.ndim != 2 or (width is not None and frames.shape[1] != width):
        raise InputError(f"{what} has shape {frames.shape}, expected frames × {width or 'values'}")
    if len(frames) == 0:
        raise InputError(f"{what} has no frames")
    if not np.isfinite(frames).all():
        raise InputError(
            f"{what}, frame {int(np.argwhere(~np.isfinite(frames))[0][0])}: a number is not finite"
        )
    return frames


def _check_names(measure: str, reduction: str) -> None:
    if measure not in _MEASURES:
        raise InputError(f"there is no measure {measure!r}; there are {', '.join(_MEASURES)}")
    if reduction not in ("max", "mean"):
        raise InputError(f"reduction is {reduction!r}, expected 'max' or 'mean'")


@dataclass(frozen=True, eq=False)
class Index:
    """Segments ready to be ranked; made by `build` or read by `open`.

    Parameters
    ----------
    take, start, end
        S segments: name of the take, first frame and the frame after the last.
    mean : (S, D) float64
    basis : (S, dims, D) float64
        Principal directions of each segment (`subspace.fit`); rows of zeros where it varies in fewer.
    jvh : (S, D) float64
        Histogram of movement.
    frames : (N, D) float32
        The frames drawn from each segment, end to end.
    offsets : (S + 1,) int64
        First of a segment's rows in `frames`.
    samples
        Frames drawn from each side (K); None: all.
    seed
        Seed of the draw.
    models
        GP-LVMs of the segments (`trained`); None: trained by the defaults when first asked for.
    """

    take: tuple[str, ...]
    start: NDArray[np.int64]
    end: NDArray[np.int64]
    mean: Floats
    basis: Floats
    jvh: Floats
    frames: NDArray[np.float32]
    offsets: NDArray[np.int64]
    samples: int | None
    seed: int
    models: latent.Models | None = None

    @cached_property
    def _models(self) -> latent.Models:
        return self.models or latent.train(self.frames, self.offsets, latent.Settings())

    @cached_property
    def _blocks(self) -> NDArray[np.float32]:
        # values before frames: the kernels' inner loop runs over frames that lie side by side
        return np.concatenate([self.frames[a:b].T.ravel() for a, b in pairwise(self.offsets)])

    @cached_property
    def _roots(self) -> Floats:
        return np.sqrt(self.jvh)

    @cached_property
    def _segments(self) -> nearest.Segments:
        return nearest.segments(self.mean, self.basis, self._roots, self._blocks, self.frames, self.offsets)

    @cached_property
    def _sequences(self) -> dtw.Sequences:
        return dtw.prepare(self.frames, self.offsets)

    @cached_property
    def _bases_side_by_side(self) -> Floats:
        return np.ascontiguousarray(np.moveaxis(self.basis, 0, -1))

    def __len__(self) -> int:
        return len(self.take)

    @classmethod
    def build(
        cls,
        features: Sequence[ArrayLike],
        segments: Sequence[tuple[str, int, int, int]],
        *,
        dims: int = 5,
        samples: int | None = 50,
        seed: int = 0,
    ) -> Index:
        """Fit a subspace to each segment and draw its frames.

        Parameters
        ----------
        features
            (T, 42) arrays, one per take.
        segments
            Name of the take, its place in `features`, start (inclusive) and end (exclusive) frame.
        dims
            Dimensions of the subspaces.
        samples
            Frames drawn from each side (K of eq. 2); None: all frames.
        seed
            A segment's draw depends on this, its take's name, start and end alone, not on its neighbours.

        Raises
        ------
        InputError
            There are no segments, one is empty or reaches outside its take, or a number is not finite.
        """
        if dims < 1 or (samples is not None and samples < 1):
            raise InputError(f"{dims} dimensions and {samples} samples, expected at least 1 of each")
        if len(segments) == 0:
            raise InputError("there are no segments to index")
        width = np.shape(features[0])[-1]
        takes = [_checked(x, width, f"features {i}") for i, x in enumerate(features)]
        mean, basis, histogram, drawn = [], [], [], []
        for name, i, start, end in segments:
            if not (0 <= i < len(takes) and 0 <= start < end <= len(takes[i])):
                raise InputError(
                    f"take {name!r}: the segment from frame {start} to {end} is empty or outside the take"
                )
            x = takes[i][start:end]
            m, b = subspace.fit(x, dims)
            mean.append(m)
            basis.append(b)
            histogram.append(jvh(x))
            drawn.append(_draw(x, samples, f"{seed} {start} {end} {name}".encode()).astype(np.float32))
        return cls(
            tuple(s[0] for s in segments),
            np.array([s[2] for s in segments], dtype=np.int64),
            np.array([s[3] for s in segments], dtype=np.int64),
            np.array(mean),
            np.array(basis),
            np.array(histogram),
            np.concatenate(drawn),
            np.concatenate([[0], np.cumsum([len(d) for d in drawn])]).astype(np.int64),
            samples,
            seed,
        )

    @property
    def dims(self) -> int:
        """Dimensions of the subspaces."""
        return int(self.basis.shape[1])

    def trained(self, settings: latent.Settings) -> Index:
        """This index with the GP-LVM of each segment, trained by these settings."""
        return replace(self, models=latent.train(self.frames, self.offsets, settings))

    def rank(
        self, x: ArrayLike, measure: str = "DSPM(PCA)", k: int | None = None, *, reduction: str = "max"
    ) -> Ranking:
        """Rank the segments by their distance from a query.

        Parameters
        ----------
        x : (T, 42)
            Features of the query, T ≥ 1.
        measure
            One of `measures`.
        k
            How many to return; None: all.
        reduction
            How SM reduces over the query's frames, "max" or "mean" (not printed in [P]); other measures
            ignore it.

        Returns
        -------
        Ranking
            Nearest first. The same query gives the same ranking: its frames are drawn by a seed from its
            content.

        Raises
        ------
        InputError
            The query is empty, too narrow or wide, or not finite; the measure is unknown; k is less than 1.
        """
        _check_names(measure, reduction)
        if k is not None and 1 <= k < len(self):
            query = self._query(x)
            if measure == "DTW":
                return ranking(dtw.first(self._sequences, self._drawn(query), k), k)
            if k * _FEW < len(self) and (first := self._first(query, k, measure)) is not None:
                return first
        return ranking(self.distances(x, measure, reduction=reduction), k)

    def distances(self, x: ArrayLike, measure: str = "DSPM(PCA)", *, reduction: str = "max") -> Floats:
        """Distance of each segment from a query, (S,) float64; parameters and errors as `rank`.

        Notes
        -----
        DSPM
            D(Q, H) = max(max_n Err(H, x_n), max_n Err(Q, x^H_n)), metres ([P], eq. 2).
        SM
            max_n Err(H, x_n), metres (eq. 1): the segment's subspace and the query's frames.
        MSM
            1 − Σ cos² θ_i / M over the canonical angles θ_i of the two subspaces, M the number of dimensions
            in which the query varies: the mean of all angles, because the first alone is near 0 for most
            pairs of body motions. 0: the query's subspace lies within the segment's.
        DTW
            Root of the smallest sum of squared distances along a warping path through the frames drawn from
            each side in time's order; through whole sequences, as in [P], where the index keeps all frames
            (`samples=None`).
        mean pose
            Distance of the two means, metres. A naive measure, to compare with.
        SM(GP-LVM), DSPM(GP-LVM)
            The same with GP-LVMs in the place of subspaces: Err is the distance of a frame from its projection
            to the latent space and back (`gplvm.project`).
        …+Jvh
            The distance times the Hellinger distance √(1 − B) of the histograms of movement, B their
            Bhattacharyya coefficient (eqs. 3, 4). [P] does not print its rule; this one was the best of seven
            products on development queries.
        """
        _check_names(measure, reduction)
        query = self._query(x)
        plain = measure.removesuffix("+Jvh")
        distance: Floats
        if plain == "DTW":
            distance = dtw.distances(self._sequences, self._drawn(query))
        elif plain == "mean pose":
            distance = np.sqrt(np.square(self.mean - query.mean(axis=0)).sum(axis=1))
        elif plain in _LATENT:
            distance = self._latent_distances(query, plain, reduction == "mean")
        else:
            distance = self._subspace_distances(query, plain, reduction == "mean")
        if measure.endswith("+Jvh"):
            distance = distance * self._hellinger(query)
        return distance

    def _query(self, x: ArrayLike) -> Floats:
        return _checked(x, self.mean.shape[1], "the query")

    def _hellinger(self, query: Floats) -> Floats:
        return np.sqrt(1.0 - bhattacharyya(self._roots, jvh(query)))

    def _drawn(self, query: Floats) -> Floats:
        # column sums name the query: they cost nothing and differ between any two recordings
        return _draw(query, self.samples, query.sum(axis=0).tobytes() + b"%d" % self.seed)

    def _first(self, query: Floats, k: int, measure: str) -> Ranking | None:
        """The first k; None: there is no short cut."""
        plain, with_jvh = measure.removesuffix("+Jvh"), measure.endswith("+Jvh")
        if plain not in ("DSPM(PCA)", "MSM"):
            return None
        mean, basis = subspace.fit(query, self.dims)
        root = np.sqrt(jvh(query)) if with_jvh else np.zeros(query.shape[1])
        if not basis.any() or (with_jvh and not root.any()):
            return None
        frames = self._drawn(query) if plain == "DSPM(PCA)" else query[:1]  # MSM looks at no frames
        first = nearest.dspm_first if plain == "DSPM(PCA)" else nearest.msm_first
        seen = nearest.Query(
            np.ascontiguousarray(frames.T), nearest.telling(frames), mean[None], basis[None], root
        )
        found, distance = first(self._segments, seen, k)
        if plain == "MSM" and not len(found):
            distance = self._msm(basis)
            return ranking(distance * self._hellinger(query) if with_jvh else distance, k)
        return ranking(distance, k, found)

    def _msm(self, basis: Floats) -> Floats:
        rank = int(basis.any(axis=1).sum())
        if not rank:  # a query that stands still has no subspace: all segments are equally far
            return np.ones(len(self))
        distance: Floats = np.maximum(1.0 - subspace.shared(self._bases_side_by_side, basis) / rank, 0.0)
        return distance

    def _subspace_distances(self, query: Floats, measure: str, mean_not_max: bool) -> Floats:
        mean, basis = subspace.fit(query, self.dims)
        if measure == "MSM":
            return self._msm(basis)
        block = np.ascontiguousarray(self._drawn(query).T)
        to: Floats = subspace.frames_to_subspaces(
            block, self.mean, self.basis, mean_not_max and measure == "SM(PCA)"
        )
        if measure == "SM(PCA)":
            return to
        back: Floats = subspace.samples_to_subspace(self._blocks, self.offsets, mean, basis)
        return np.maximum(to, back)

    def _latent_distances(self, query: Floats, measure: str, mean_not_max: bool) -> Floats:
        drawn = self._drawn(query)
        errors = self._models.errors(drawn)
        if measure == "SM(GP-LVM)":
            there: Floats = errors.mean(axis=1) if mean_not_max else errors.max(axis=1)
            return there
        both: Floats = np.maximum(errors.max(axis=1), self._models.errors_back(drawn))
        return both

    def save(self, path: str | os.PathLike[str], sources: Mapping[str, str] | None = None) -> None:
        """Write the index ("miburi/index"), with the digests of what it was made from.

        `samples` is (S, K, D); with all frames kept it is (N, D) and `offsets` (S + 1) says where segments
        begin.
        """
        with store.create(path, "index", sources) as file:
            store.put(file, "take", list(self.take))
            for name in ("start", "end", "mean", "basis", "jvh"):
                store.put(file, name, getattr(self, name))
            if self.samples is None:
                store.put(file, "samples", self.frames)
                store.put(file, "offsets", self.offsets)
            else:
                store.put(file, "samples", self.frames.reshape(len(self), self.samples, -1))
            file.attrs["dims"] = self.dims
            file.attrs["samples"] = 0 if self.samples is None else self.samples
            file.attrs["seed"] = self.seed

    @classmethod
    def open(cls, path: str | os.PathLike[str], models: str | os.PathLike[str] | None = None) -> Index:
        """Read an index that `save` wrote, and the GP-LVMs of its segments that `models.save` wrote.

        Raises
        ------
        InputError
            A file is missing, damaged or of another format, its arrays do not fit together, or the models
            are of another index.
        """
        with store.open_checked(path, "index") as file:
            try:
                dims, samples, seed = (int(file.attrs[a]) for a in ("dims", "samples", "seed"))
            except KeyError:
                raise InputError(
                    f"{path}: an attribute is missing, expected dims, samples and seed"
                ) from None
            take = store.get_strings(file, "take")
            s = len(take)
            mean = store.get(file, "mean", (s, None))
            width = mean.shape[1]
            if samples:
                frames = store.get(file, "samples", (s, samples, width)).reshape(-1, width)
                offsets = np.arange(s + 1, dtype=np.int64) * samples
            else:
                frames, offsets = (
                    store.get(file, "samples", (None, width)),
                    store.get(file, "offsets", (s + 1,)),
                )
                if offsets[0] != 0 or offsets[-1] != len(frames) or (np.diff(offsets) < 1).any():
                    raise InputError(
                        f"{path}: /offsets do not cut the {len(frames)} frames into {s} segments"
                    )
            index = cls(
                tuple(take),
                store.get(file, "start", (s,)),
                store.get(file, "end", (s,)),
                mean,
                store.get(file, "basis", (s, dims, width)),
                store.get(file, "jvh", (s, width)),
                frames,
                offsets,
                samples or None,
                seed,
            )
        if models is None:
            return index
        return replace(index, models=latent.open_models(models, index.frames, index.offsets))
