"""Measures, ranking and the index on disk."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import subspace_angles

import miburi.retrieval.index
from miburi.errors import InputError
from miburi.retrieval import Index, Ranking, dtw, measures, merge
from miburi.retrieval.index import _draw
from miburi.retrieval.jvh import bhattacharyya, jvh
from miburi.retrieval.ranking import ranking
from miburi.retrieval.subspace import fit

from . import naive

DIMS = 5
# measures whose first k are found without computing all distances
SHORT_CUTS = ("DSPM(PCA)", "MSM", "DSPM(PCA)+Jvh", "MSM+Jvh", "DTW")


def takes(seed=0, count=4, frames=150, width=42):
    """Smooth random features: what neighbouring frames of a motion look like."""
    rng = np.random.default_rng(seed)
    t = 0.06 * np.arange(frames)[:, None, None]
    waves = np.sin(t * rng.uniform(0.3, 2.0, (count, 6)) + rng.uniform(0, 6, (count, 6)))
    return [
        (w @ rng.normal(0, 0.2, (6, width)) + rng.normal(0, 0.3, width)).astype(np.float32)
        for w in np.moveaxis(waves, 1, 0)
    ]


def cut(features, length=50, step=50):
    # pieces that share no frame: two that share their worst frame are equally far
    return [
        (f"take{i}", i, a, a + length)
        for i, x in enumerate(features)
        for a in range(0, len(x) - length + 1, step)
    ]


@pytest.fixture(scope="module")
def features():
    return takes()


@pytest.fixture(scope="module")
def segments(features):
    return cut(features)


@pytest.fixture(scope="module")
def index(features, segments):
    return Index.build(features, segments, dims=DIMS)


@pytest.fixture(scope="module")
def whole(features, segments):
    """All frames of all segments."""
    return Index.build(features, segments, dims=DIMS, samples=None)


@pytest.fixture(scope="module")
def query():
    return takes(seed=7, count=1, frames=90)[0]


def frames_of(features, segment):
    _, i, a, b = segment
    return features[i][a:b].astype(np.float64)


# ---- the equations


@pytest.mark.parametrize("samples", [None, 50])
def test_dspm_is_equation_2(features, segments, query, samples):
    index = Index.build(features, segments, dims=DIMS, samples=samples)
    got = index.distances(query, "DSPM(PCA)")
    if samples is None:
        drawn_query = query.astype(np.float64)
    else:
        # the draw is part of the measure; what it draws is tested below
        drawn_query = index._drawn(query.astype(np.float64))
        assert len(np.unique(drawn_query, axis=0)) == samples
    for s, segment in enumerate(segments):
        drawn = index.frames[index.offsets[s] : index.offsets[s + 1]].astype(np.float64)
        want = naive.dspm(frames_of(features, segment), query.astype(np.float64), DIMS, drawn, drawn_query)
        assert got[s] == pytest.approx(want, abs=1e-6)


@pytest.mark.parametrize("reduction", ["max", "mean"])
def test_sm_is_equation_1_over_the_querys_frames(features, segments, query, reduction):
    index = Index.build(features, segments, dims=DIMS, samples=None)
    got = index.distances(query, "SM(PCA)", reduction=reduction)
    for s, segment in enumerate(segments):
        want = naive.sm(frames_of(features, segment), query, DIMS, max if reduction == "max" else np.mean)
        assert got[s] == pytest.approx(want, abs=1e-6)


def test_msm_is_the_mean_of_the_canonical_angles(features, segments, query, index):
    got = index.distances(query, "MSM")
    q = naive.subspace(query.astype(np.float64), DIMS)[1]
    for s, segment in enumerate(segments):
        h = naive.subspace(frames_of(features, segment), DIMS)[1]
        assert got[s] == pytest.approx(1 - np.mean(np.cos(subspace_angles(h.T, q.T)) ** 2), abs=1e-7)


def test_dtw_is_the_cheapest_path(features, query):
    segments = [("take0", 0, 0, 30), ("take0", 0, 7, 8), ("take1", 1, 50, 150), ("take2", 2, 0, 2)]
    index = Index.build(features, segments, dims=DIMS, samples=None)
    for x in (query[:40], query[:1], query[:70]):
        want = [naive.dtw(x.astype(np.float64), frames_of(features, s)) for s in segments]
        np.testing.assert_allclose(index.distances(x, "DTW"), want, rtol=1e-9)


@settings(max_examples=30)
@given(st.integers(1, 140), st.lists(st.integers(1, 9), min_size=1, max_size=6), st.integers(0, 999))
def test_dtw_of_any_lengths(n, lengths, seed):
    rng = np.random.default_rng(seed)
    parts = [rng.normal(0, 1, (m, 9)).cumsum(axis=0) for m in lengths]
    frames = np.concatenate(parts).astype(np.float32)
    ends = np.cumsum([0, *lengths])
    index = Index.build([frames], [("a", 0, a, b) for a, b in pairwise(ends)], dims=1, samples=None)
    query = rng.normal(0, 1, (n, 9)).cumsum(axis=0)
    want = [naive.dtw(query, frames[a:b].astype(np.float64)) for a, b in pairwise(ends)]
    np.testing.assert_allclose(index.distances(query, "DTW"), want, rtol=1e-9)


def test_dtw_agrees_with_dtaidistance(features, segments, query, whole):
    dtw_ndim = pytest.importorskip("dtaidistance.dtw_ndim")
    x = query.astype(np.float64)
    want = [dtw_ndim.distance(x, frames_of(features, s)) for s in segments]
    np.testing.assert_allclose(whole.distances(query, "DTW"), want, rtol=1e-6)
    # of a sequence and itself squares cancel; what rounding leaves is far below a millimetre
    np.testing.assert_allclose(whole.distances(frames_of(features, segments[4]), "DTW")[4], 0, atol=1e-6)


@given(st.integers(1, 60), st.integers(1, 40), st.integers(0, 999))
def test_dtw_bounds_are_below(n, m, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(0, 1, (n, 12)).cumsum(axis=0), rng.normal(0, 1, (m, 12)).cumsum(axis=0)
    y = y.astype(np.float32)
    known = dtw.prepare(y, np.array([0, m]))
    true = naive.dtw(x, y.astype(np.float64)) ** 2
    rest = dtw._rest(np.ascontiguousarray(x.T), known.low, known.high, 0.0)
    short = dtw._columns(dtw._shortened(x, known.axes), np.square(x).sum(axis=1))
    least = dtw._all(short, known.short, known.offsets)[0] ** 2
    assert rest[0, 0] <= true * (1 + 1e-9) and least <= true * (1 + 1e-9) + 1e-9


def test_mean_pose_is_the_distance_of_the_means(features, segments, query, index):
    want = [np.linalg.norm(frames_of(features, s).mean(0) - query.astype(float).mean(0)) for s in segments]
    np.testing.assert_allclose(index.distances(query, "mean pose"), want, atol=1e-9)


@pytest.mark.parametrize("measure", ["DSPM(PCA)", "SM(PCA)", "MSM"])
def test_jvh_multiplies_by_the_hellinger_distance(features, segments, query, index, measure):
    plain, with_jvh = index.distances(query, measure), index.distances(query, measure + "+Jvh")
    b = [naive.coefficient(naive.histogram(frames_of(features, s)), naive.histogram(query)) for s in segments]
    np.testing.assert_allclose(with_jvh, plain * np.sqrt(1 - np.array(b)), rtol=1e-6)


def test_coefficient_of_equal_histograms_is_one_and_of_disjoint_ones_zero():
    x = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 3.0, 0.0]])
    y = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 5.0]])
    still = np.zeros(3)
    np.testing.assert_allclose(jvh(x), [2 / 5, 3 / 5, 0])
    np.testing.assert_allclose(bhattacharyya(np.sqrt([jvh(x), jvh(y), still]), jvh(x)), [1, 0, 0])
    np.testing.assert_allclose(bhattacharyya(np.sqrt([jvh(x), still]), still), [0, 1])


# ---- one battery for all measures


@pytest.mark.parametrize("measure", measures())
class TestEveryMeasure:
    def test_a_segment_as_query_ranks_itself_first(self, features, segments, whole, measure):
        for s in range(0, len(segments), 5):
            assert whole.rank(frames_of(features, segments[s]), measure, k=1).order[0] == s

    def test_permuting_the_database_permutes_the_ranking(self, features, segments, query, index, measure):
        shuffled = np.random.default_rng(1).permutation(len(segments))
        other = Index.build(features, [segments[s] for s in shuffled], dims=DIMS)
        a, b = index.rank(query, measure), other.rank(query, measure)
        np.testing.assert_array_equal(shuffled[b.order], a.order)
        np.testing.assert_array_equal(a.score, b.score)

    def test_equal_segments_are_ordered_by_index(self, features, segments, query, measure):
        index = Index.build(features, [segments[3]] * 4 + segments[:3] + [segments[3]] * 3, dims=DIMS)
        order = index.rank(query, measure).order
        twins = order[np.isin(order, [0, 1, 2, 3, 7, 8, 9])]
        np.testing.assert_array_equal(twins, [0, 1, 2, 3, 7, 8, 9])
        for k in (1, 2, 5, 8):
            np.testing.assert_array_equal(index.rank(query, measure, k).order, order[:k])

    def test_the_first_k_are_the_first_k(self, query, index, measure):
        whole = index.rank(query, measure)
        assert sorted(whole.order) == list(range(len(index)))
        assert (np.diff(whole.score) >= 0).all()
        for k in (1, 7, len(index), len(index) + 5):
            some = index.rank(query, measure, k)
            np.testing.assert_array_equal(some.order, whole.order[:k])
            np.testing.assert_array_equal(some.score, whole.score[:k])

    def test_shards_merge_to_the_whole(self, features, segments, query, index, measure):
        shards = [
            Index.build(features, segments[a:b], dims=DIMS) for a, b in ((0, 5), (5, 6), (6, len(segments)))
        ]
        merged = merge([s.rank(query, measure, 6) for s in shards], [len(s) for s in shards], 6)
        whole = index.rank(query, measure, 6)
        np.testing.assert_array_equal(merged.order, whole.order)
        np.testing.assert_array_equal(merged.score, whole.score)

    def test_the_same_query_gives_the_same_ranking(self, features, segments, query, index, measure):
        again = Index.build(features, segments, dims=DIMS)
        np.testing.assert_array_equal(
            again.rank(query, measure).score, index.rank(query.copy(), measure).score
        )

    def test_moving_everything_alike_changes_no_order(self, features, segments, query, whole, measure):
        shift = np.random.default_rng(2).normal(size=42)
        a = whole
        b = Index.build([x + shift for x in features], segments, dims=DIMS, samples=None)
        # frames are kept as float32; a hundred iterations of training carry that rounding further
        share = 0.05 if "GP-LVM" in measure else 0.0
        np.testing.assert_allclose(
            a.distances(query, measure), b.distances(query + shift, measure), atol=1e-4, rtol=share
        )

    def test_bad_queries_are_refused(self, query, index, measure):
        for bad, sentence in (
            (np.where(np.arange(90)[:, None] == 4, np.nan, query), "frame 4: a number is not finite"),
            (np.where(np.arange(90)[:, None] == 4, np.inf, query), "frame 4: a number is not finite"),
            (query[:, :41], r"shape \(90, 41\), expected frames × 42"),
            (query[0], "shape"),
            (query[:0], "no frames"),
        ):
            with pytest.raises(InputError, match=sentence):
                index.rank(bad, measure)
        with pytest.raises(InputError, match="first 0"):
            index.rank(query, measure, 0)

    def test_short_and_still_segments_are_ranked(self, features, query, measure):
        x = [*features, np.zeros((20, 42), np.float32)]
        segments = [("take0", 0, 0, 1), ("take0", 0, 5, 8), ("still", 4, 0, 20), ("take1", 1, 0, 80)]
        index = Index.build(x, segments, dims=DIMS)
        assert np.isfinite(index.distances(query, measure)).all()
        for one in (x[0][:1], x[4]):
            assert np.isfinite(index.distances(one, measure)).all()


@pytest.mark.parametrize("measure", ["MSM", "MSM+Jvh"])
def test_msm_does_not_see_where_the_query_is(query, index, measure):
    np.testing.assert_allclose(
        index.distances(query, measure), index.distances(query + 0.5, measure), atol=1e-6
    )


def test_a_query_in_the_same_place_is_nearer_to_dspm(features, segments, index):
    x = frames_of(features, segments[2])
    away = x + 1.0
    assert index.distances(away)[2] > index.distances(x)[2] + 0.5


def check_first(index, query, k):
    """The short cuts, also for more than the part of the segments that they are taken for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(miburi.retrieval.index, "_FEW", 1)
        for measure in SHORT_CUTS:
            whole, some = index.rank(query, measure), index.rank(query, measure, k)
            np.testing.assert_array_equal(some.order, whole.order[:k])
            np.testing.assert_array_equal(some.score, whole.score[:k])


@given(
    st.integers(0, 10_000),
    st.integers(1, 12),
    st.sampled_from([None, 8]),
    st.sampled_from([0.0, 300.0]),
    st.sampled_from([4, 6, 31]),
    st.sampled_from([1.0, 1e22]),
)
def test_bounds_lose_none_of_the_first(seed, k, samples, far, width, scale):
    """Clusters of segments at very different distances, short and still ones, some far from the origin or huge."""
    rng = np.random.default_rng(seed)
    centres = rng.normal(0, 10.0 ** rng.uniform(-3, 1), (4, width)) + far
    x, segments, at = [], [], 0
    for _ in range(30):
        n = int(rng.integers(1, 15))
        moves = (
            rng.normal(0, 10.0 ** rng.uniform(-4, 0), (n, 2))
            @ rng.normal(size=(2, width))
            * rng.integers(0, 2)
        )
        x.append(centres[rng.integers(4)] + moves + rng.normal(0, 1e-3, (n, width)) * rng.integers(0, 2))
        segments.append(("a", 0, at, at + n))
        at += n
    frames = (scale * np.concatenate(x)).astype(np.float32)
    index = Index.build([frames], segments, dims=2, samples=samples)
    query = scale * (x[rng.integers(30)] + rng.normal(0, 0.01, width))
    check_first(index, query, k)


@given(st.integers(0, 10_000), st.integers(1, 10), st.floats(-1, 0.5), st.floats(1, 6), st.integers(3, 42))
def test_rounding_loses_none_of_the_first(seed, k, size, ratio, width):
    """Frames swing far along one direction, and lie as far beside it as their mean does: ties but for rounding."""
    rng = np.random.default_rng(seed)
    along = rng.normal(size=width) * (np.arange(width) < width - 1)
    along *= 10.0**size / np.linalg.norm(along)
    beside = 10.0 ** (size - ratio) * np.eye(width)[-1]
    swing = np.repeat([-1.0, 1.0], 5)[:, None]
    x = [
        swing * along * rng.choice([1.0, rng.uniform(0.9, 1.1)]) + beside * rng.integers(0, 30)
        for _ in range(30)
    ]
    segments = [("a", 0, 10 * i, 10 * i + 10) for i in range(30)]
    index = Index.build([np.concatenate(x)], segments, dims=int(rng.integers(1, 4)))
    check_first(index, x[0], k)
    check_first(index, x[3] + 0.3 * beside, k)


@pytest.mark.parametrize("samples", [2, 20, 50])
@pytest.mark.parametrize("k", [1, 3, 8])
def test_frames_that_were_not_drawn_say_nothing(samples, k):
    """Excursions that few draws meet move the mean of all frames, but not that of those that are compared."""
    rng = np.random.default_rng(0)
    x = [rng.normal(size=(500, 42)) * 1e-3 for _ in range(80)]
    for i, frames in enumerate(x):
        if i % 2:
            frames[:, 0] += 0.01
        else:
            frames[:5, 7] += 1.5
    index = Index.build(x, [("a", i, 0, 500) for i in range(80)], samples=samples)
    query = rng.normal(size=(80, 42)) * 1e-3
    check_first(index, query, k)


# ---- fitting, drawing, ordering


@given(st.integers(1, 12), st.integers(1, 8), st.integers(1, 6), st.integers(0, 99))
def test_a_basis_is_orthonormal_or_zero_and_reaches_the_best_error(n, width, dims, seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(n, width))
    if seed % 3 == 0:
        x[:] = x[0]
    if seed % 3 == 1:
        x = np.repeat(x[: (n + 1) // 2], 2, axis=0)[:n]
    mean, basis = fit(x, dims)
    assert basis.shape == (dims, width)
    want_mean, want = naive.subspace(x, dims)
    rank = len(want)
    np.testing.assert_allclose(mean, want_mean, atol=1e-12)
    np.testing.assert_allclose(basis[:rank] @ basis[:rank].T, np.eye(rank), atol=1e-9)
    assert not basis[rank:].any()
    left = np.square((x - mean) - (x - mean) @ basis.T @ basis).sum()
    assert left == pytest.approx(np.square((x - mean) - (x - mean) @ want.T @ want).sum(), abs=1e-9)


@given(st.lists(st.integers(0, 3), min_size=1, max_size=30), st.integers(1, 35))
def test_ranking_is_a_stable_sort(values, k):
    want = sorted(range(len(values)), key=lambda i: (values[i], i))
    np.testing.assert_array_equal(ranking(values).order, want)
    np.testing.assert_array_equal(ranking(values, k).order, want[:k])


def test_drawn_frames_are_frames_without_repeats_in_order():
    x = np.arange(200.0)[:, None]
    drawn = _draw(x, 50, b"a")[:, 0]
    assert len(np.unique(drawn)) == 50
    assert (np.diff(drawn) > 0).all()
    assert (_draw(x, 50, b"b")[:, 0] != drawn).any()
    np.testing.assert_array_equal(np.unique(_draw(x[:7], 50, b"a")), np.arange(7))


def test_every_frame_is_drawn_equally_often():
    x = np.arange(60.0)[:, None]
    times = np.zeros(60)
    for i in range(3000):
        times[_draw(x, 20, b"%d" % i)[:, 0].astype(int)] += 1
    deviation = np.sqrt(3000 * (1 / 3) * (2 / 3))
    assert np.abs(times - 1000).max() < 4.5 * deviation


# ---- building and keeping


@pytest.mark.parametrize("samples", [None, 50, 3])
def test_an_index_read_again_ranks_alike(tmp_path, features, segments, query, samples):
    index = Index.build(features, [*segments[:-1], ("take0", 0, 3, 6)], dims=DIMS, samples=samples, seed=9)
    index.save(tmp_path / "a.h5", {"x": "0"})
    index.save(tmp_path / "b.h5", {"x": "0"})
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()
    again = Index.open(tmp_path / "a.h5")
    assert (again.take, again.samples, again.seed, again.dims) == (index.take, samples, 9, DIMS)
    for measure in measures():
        a, b = index.rank(query, measure), again.rank(query, measure)
        np.testing.assert_array_equal(a.order, b.order)
        np.testing.assert_array_equal(a.score, b.score)


def test_the_layout_on_disk(tmp_path, index):
    import h5py

    index.save(tmp_path / "index.h5")
    s = len(index)
    with h5py.File(tmp_path / "index.h5") as file:
        shapes = {k: v.shape for k, v in file.items()}
        assert file.attrs["format"] == "miburi/index"
        assert (file.attrs["dims"], file.attrs["samples"], file.attrs["seed"]) == (5, 50, 0)
    assert shapes == {
        "take": (s,), "start": (s,), "end": (s,), "mean": (s, 42), "basis": (s, 5, 42), "samples": (s, 50,
        42), "jvh": (s, 42),
    }  # fmt: skip


def test_a_damaged_index_is_refused(tmp_path, index):
    import h5py

    path = tmp_path / "index.h5"
    index.save(path)
    with h5py.File(path, "a") as file:
        del file["mean"]
        file["mean"] = np.zeros((3, 42))
    with pytest.raises(InputError, match="mean has shape"):
        Index.open(path)
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(InputError, match=r"index\.h5"):
        Index.open(path)
    with pytest.raises(InputError, match="no such file"):
        Index.open(tmp_path / "other.h5")


@pytest.mark.parametrize(
    ("segments", "sentence"),
    [
        ([], "no segments"),
        ([("a", 0, 5, 5)], "take 'a'.*empty or outside"),
        ([("a", 0, 250, 301)], "take 'a'.*empty or outside"),
        ([("a", 9, 0, 5)], "take 'a'.*empty or outside"),
        ([("a", 0, -3, 5)], "take 'a'.*empty or outside"),
    ],
)
def test_bad_segments_are_refused(features, segments, sentence):
    with pytest.raises(InputError, match=sentence):
        Index.build(features, segments)


def test_bad_features_and_settings_are_refused(features, query, index):
    bad = features[0].copy()
    bad[17, 3] = np.nan
    with pytest.raises(InputError, match="features 1, frame 17"):
        Index.build([features[0], bad], [("a", 0, 0, 9)])
    with pytest.raises(InputError, match="shape"):
        Index.build([features[0], features[1][:, :7]], [("a", 0, 0, 9)])
    with pytest.raises(InputError, match="0 dimensions"):
        Index.build(features, [("a", 0, 0, 9)], dims=0)
    with pytest.raises(InputError, match="no measure 'DSPM'; there are DTW, mean pose"):
        index.rank(query, "DSPM")
    with pytest.raises(InputError, match="reduction"):
        index.rank(query, "SM(PCA)", reduction="median")


def test_merge_breaks_ties_by_place():
    a = Ranking(np.array([1, 0]), np.array([0.5, 0.7]))
    b = Ranking(np.array([0, 2]), np.array([0.5, 0.6]))
    merged = merge([a, b], [2, 3])
    np.testing.assert_array_equal(merged.order, [1, 2, 4, 0])
    np.testing.assert_array_equal(merged.score, [0.5, 0.5, 0.6, 0.7])
