"""Pictures: what is drawn, where the camera stands, and that few draws give the picture of many."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from miburi.errors import InputError
from miburi.figures import HAND, PERSON
from miburi.formats.glove import motion as hand
from miburi.kinematics import euler
from miburi.motion import Motion, Skeleton
from miburi.render import figure, scene

BENCH = Path(__file__).parents[2] / "benchmarks/bench_render.py"
places = hnp.arrays(np.float64, (5, 3), elements=st.floats(-3, 3, width=32))


def fist(frames: int = 6) -> Motion:
    """An open hand that closes."""
    bend = np.zeros((frames, 16, 3))
    for j, name in enumerate(HAND.joints):
        if name[-1] in "123" and not name.startswith("thumb"):
            bend[:, j, 1] = np.linspace(0, (75, 100, 60)[int(name[-1]) - 1], frames)
    return hand(bend.reshape(frames, 48), 30)


def person(frames: int = 4, yaw: float = 0.0, step: float = 0.0) -> Motion:
    """A person who faces +z, turned by yaw degrees, left arm out, who goes `step` metres a frame."""
    turns = np.zeros((frames, 14, 3))
    turns[:, 0, 2] = yaw
    turns[:, PERSON.index("l_shoulder"), 0] = 80
    root = np.zeros((frames, 3))
    root[:, 1] = 0.9
    root[:, 2] = step * np.arange(frames)
    return Motion(PERSON, 30, root, euler(turns, "ZXY"))


def colourful(picture: np.ndarray) -> np.ndarray:
    """Where something of colour is: background and grid have none."""
    return np.ptp(picture.astype(np.int16), axis=-1) > 30


def warm(picture: np.ndarray) -> np.ndarray:
    return colourful(picture) & (picture[..., 0] > picture[..., 2])


def test_the_hand_stands_upright_and_nothing_is_cut_off():
    pictures = list(scene.frames(fist(), width=320, height=240))
    assert len(pictures) == 6
    heights = []
    for p in pictures:
        assert p.shape == (240, 320, 3) and p.dtype == np.uint8
        assert (p[:4, :4] == 255).all()
        seen = colourful(p)
        assert 0.01 < seen.mean() < 0.4
        assert not seen[[0, -1]].any() and not seen[:, [0, -1]].any()
        rows = np.flatnonzero(seen.any(axis=1))
        heights.append(rows.max() - rows.min())
    assert heights[0] > 1.6 * heights[-1]  # fingers up, then a fist
    grey = (np.ptp(pictures[0].astype(np.int16), axis=-1) < 12) & (pictures[0][..., 0] < 225)
    assert 0.004 < grey.mean() < 0.2  # a grid that can be seen


def test_the_right_hands_thumb_is_on_the_right_when_the_palm_is_seen():
    picture = next(scene.frames(fist(2), width=320, height=240))
    red = (picture[..., 0] > 1.7 * picture[..., 1]) & colourful(picture)
    violet = (picture[..., 2] > 1.25 * picture[..., 1]) & (picture[..., 0] > 1.05 * picture[..., 1])
    assert np.argwhere(red)[:, 1].mean() > np.argwhere(violet)[:, 1].mean() + 30


@pytest.mark.parametrize("yaw", [0.0, 90.0, 200.0])
def test_a_person_is_seen_from_before_whichever_way_she_faces(yaw):
    picture = next(scene.frames(person(yaw=yaw), width=320, height=240))
    left, right = warm(picture), colourful(picture) & ~warm(picture)
    columns = [np.argwhere(side)[:, 1].mean() for side in (left, right)]
    assert columns[0] > columns[1] + 10  # her left is on our right
    figures = figure.group([person(yaw=yaw)])
    np.testing.assert_allclose(figures.view, _naive_view(np.radians(yaw)), atol=1e-9)


def _naive_view(yaw: float) -> np.ndarray:
    a = yaw + np.radians(35)
    return np.array([np.sin(a), np.tan(np.radians(14)), np.cos(a)])


def test_the_camera_follows_who_walks_away():
    walk, still = (figure.group([person(90, step=s)]) for s in (0.05, 0.0))
    assert np.ptp(walk.follow[:, 2]) > 3.5 and not still.follow.any()
    sizes = [np.argwhere(colourful(p))[:, 0] for p in scene.frames(person(90, step=0.05), at=[0, 45, 89])]
    assert min(np.ptp(s) for s in sizes) > 240  # as large at the end of the way as at its start


def test_figures_stand_side_by_side():
    shown = figure.group([person(3), person(5, yaw=140.0), fist(2)])
    assert shown.points.shape == (5, 15 + 15 + 21, 3)
    across = shown.points @ figure.look(shown.view)[:, 0]
    assert across[:, :15].max() < across[:, 15:30].min() < across[:, 30:].min()
    np.testing.assert_array_equal(shown.points[2:, 0:15], shown.points[2:3, :15].repeat(3, axis=0))
    # all stand on one ground
    high = person(3)
    raised = Motion(PERSON, 30, high.root + np.array([0, 1.0, 0]), high.rotations)
    level = figure.group([high, raised]).points[..., 1]
    np.testing.assert_allclose(level[:, 15:], level[:, :15], atol=1e-9)
    # and in one row, wherever they were recorded
    far = Motion(PERSON, 30, high.root + np.array([3.0, 0, -7.0]), high.rotations)
    depths = figure.group([high, far]).points @ figure.look(shown.view)[:, 2]
    np.testing.assert_allclose(depths[:, 15:].mean(), depths[:, :15].mean(), atol=1e-9)
    # the second one is turned to the camera as the first one is
    first, second = (shown.points[0, k : k + 15] - shown.points[0, k] for k in (0, 15))
    np.testing.assert_allclose(second, first, atol=1e-9)


def test_a_root_on_the_floor_is_not_drawn():
    joints = ("joint_Root", *PERSON.joints)
    parents = np.concatenate([[-1], PERSON.parents + 1])
    offsets = np.concatenate([[[0, 0, 0]], PERSON.offsets])
    offsets[1] = (0, 0.9, 0)
    carried = Skeleton(joints, parents, offsets, "carried", PERSON.ends + 1, PERSON.end_offsets)
    rotations = np.tile([0.0, 0, 0, 1], (2, 15, 1))
    shown = figure.group([Motion(carried, 30, np.zeros((2, 3)), rotations)])
    plain = figure.group(
        [Motion(PERSON, 30, np.tile([0, 0.9, 0], (2, 1)), np.tile([0.0, 0, 0, 1], (2, 14, 1)))]
    )
    assert len(shown.bones) == len(plain.bones)
    np.testing.assert_allclose(shown.points[:, 1:], plain.points)
    np.testing.assert_allclose(shown.radii[1:], plain.radii)
    # who walks away from such a root is followed
    way = np.zeros((60, 15, 3))
    way[:, 1, 2] = np.linspace(0, 6, 60)
    walks = Motion(carried, 30, np.zeros((60, 3)), np.tile(rotations[:1], (60, 1, 1)), translations=way)
    assert np.ptp(figure.group([walks]).follow[:, 2]) > 5.8


@given(places, st.floats(0.001, 0.5), st.floats(0.3, 3.0), places)
def test_framed_leaves_nothing_out(points, radius, aspect, direction):
    view = direction[0] + (0.0, 0.0, 4.0)  # never straight down
    rotation = figure.look(view)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert rotation[1, 0] == pytest.approx(0, abs=1e-12) and rotation[1, 1] > 0  # upright
    place = figure.framed(points, np.full(5, radius), rotation, aspect)
    # a ring around each ball, seen from the camera: the tangent cone's angle about the ball's own
    seen = (points - place) @ rotation
    assert (seen[:, 2] < -radius).all()
    share = []
    for axis, tangent in ((0, aspect * np.tan(figure.FIELD / 2)), (1, np.tan(figure.FIELD / 2))):
        flat = np.hypot(seen[:, axis], seen[:, 2])
        angle = np.abs(np.arctan2(seen[:, axis], -seen[:, 2])) + np.arcsin(np.minimum(radius / flat, 1))
        share.append((np.tan(angle) / tangent).max())
    assert max(share) <= 1.0  # inside
    assert max(share) > 0.8  # and no smaller than it must be


@given(places, places, st.tuples(*[st.floats(-5, 5)] * 3).map(np.array))
def test_bones_reach_from_tail_to_head(tails, heads, eye):
    radii = np.linspace(0.01, 0.05, 5)
    poses = scene.trough_poses(tails, heads, radii, eye)
    assert np.isfinite(poses).all()
    np.testing.assert_allclose(poses @ [0, 0, 0, 1], np.c_[tails, np.ones(5)])
    np.testing.assert_allclose(poses @ [0, 1, 0, 1], np.c_[heads, np.ones(5)], atol=1e-12)
    balls = scene.dome_poses(tails, radii, eye)
    assert np.isfinite(balls).all()
    apart = np.linalg.norm(eye - tails, axis=1) > 1e-6
    tips = (balls @ [0, 0, 1, 1])[apart, :3]
    nearer = np.linalg.norm(eye - tips, axis=1) - np.linalg.norm(eye - tails[apart], axis=1)
    clear = np.linalg.norm(eye - tails[apart], axis=1) > radii[apart]
    np.testing.assert_allclose(nearer[clear], -radii[apart][clear], atol=1e-9)
    for k in range(5):
        along, toward = heads[k] - tails[k], eye - tails[k]
        square = np.linalg.norm(np.cross(along, toward))
        if square > 1e-3:
            z = poses[k, :3, 2]
            assert np.linalg.norm(z) == pytest.approx(radii[k]) and abs(z @ along) < 1e-9 and z @ toward > 0


@pytest.mark.parametrize("shape", [scene.dome(), scene.trough()], ids=["dome", "trough"])
def test_shapes_are_of_radius_1_and_face_the_eye(shape):
    vertices, normals, faces = shape
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    assert (normals[:, 2] >= -1e-12).all() and set(faces.ravel()) == set(range(len(vertices)))
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    outward = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", outward, normals[faces[:, 0]]) > 0).all()  # counter-clockwise from outside
    # the faces' shadow is the whole disc or strip
    area = 0.5 * outward[:, 2].sum()
    whole = np.pi if len(vertices) == 31 else 2.0
    assert 0.98 < area / whole <= 1.0 + 1e-12


def test_two_draws_give_the_picture_of_many_nodes():
    spec = importlib.util.spec_from_file_location("bench_render", BENCH)
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    motion = fist(3)
    ours = list(scene.frames(motion))
    for mine, theirs in zip(ours, bench.one_by_one(motion, shapes=True, shaders=True), strict=True):
        np.testing.assert_array_equal(mine, theirs)
    for mine, theirs in zip(ours, bench.one_by_one(motion, shapes=False, shaders=True), strict=True):
        one, other = colourful(mine), colourful(theirs)
        assert (one & other).sum() / (one | other).sum() > 0.985
        assert np.abs(mine.astype(np.int16) - theirs).mean() < 0.5


def test_the_same_pictures_every_time_and_frame_by_frame():
    motion = fist()
    whole = list(scene.frames(motion, width=101, height=77))
    again = list(scene.frames(motion, width=101, height=77))
    np.testing.assert_array_equal(whole, again)
    some = list(scene.frames(motion, width=101, height=77, at=[4, 1]))
    np.testing.assert_array_equal(some, [whole[4], whole[1]])


def test_generators_that_are_dropped_or_run_at_the_same_time():
    one, other = scene.frames(fist(), width=64, height=64), scene.frames(person(), width=64, height=64)
    first = next(one).copy()
    next(other)
    second = next(one)
    other.close()
    third = next(one)
    assert (first != second).any()
    expected = list(scene.frames(fist(), width=64, height=64))
    np.testing.assert_array_equal([first, second, third], expected[:3])


def test_nothing_to_show():
    with pytest.raises(InputError, match="nothing to show"):
        next(scene.frames([]))
    with pytest.raises(InputError, match="nothing to show"):
        next(scene.frames(fist()[:0]))
    with pytest.raises(InputError, match="8 × 8 pixels"):
        next(scene.frames(fist(), width=8, height=8))


def test_degenerate_figures_are_drawn():
    dot = Skeleton(("a",), [-1], [[0, 0, 0]])
    picture = next(scene.frames(Motion(dot, 30, np.zeros((2, 3)), np.tile([0.0, 0, 0, 1], (2, 1, 1)))))
    assert (picture < 160).any()


def test_real_people_are_upright_with_left_and_right(recordings):
    from miburi.formats import read

    kick = read(
        recordings / "body_hdm05/kickLFront1Reps/bd_001.amc.gz",
        skeleton=recordings / "body_hdm05/asf/bd.asf",
    )
    names = kick.skeleton.joints
    shown = figure.group([kick])
    high = shown.points[:, :, 1].max(axis=0)
    assert high[names.index("lfoot")] > shown.floor + 0.4 > high[names.index("rfoot")] + 0.05
    assert shown.colours[names.index("lfoot")][0] > shown.colours[names.index("lfoot")][2]
    for picture in scene.frames(kick, at=[0, len(kick) // 2, len(kick) - 1], width=320, height=240):
        seen = colourful(picture)
        assert seen.any() and not seen[[0, -1]].any() and not seen[:, [0, -1]].any()
        assert np.argwhere(warm(picture))[:, 1].mean() > np.argwhere(seen & ~warm(picture))[:, 1].mean()
