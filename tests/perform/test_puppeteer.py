"""Simulated puppet users: what they may and may not do, and what they model."""

from __future__ import annotations

import ast
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from miburi import read
from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, PERSON
from miburi.formats import puppet
from miburi.motion import Motion
from miburi.perform.puppeteer import (
    STYLES,
    Habits,
    User,
    body,
    habits,
    imitate,
    imitation,
    plan,
    trunk,
    users,
)
from miburi.perform.puppeteer.users import _BY_SKILL, perfect

LIMB_COLUMNS = (
    (0, 1, 2, 6),
    (3, 4, 5, 7),
    (8, 9, 12),
    (10, 11, 13),
)


# naive twins -------------------------------------------------------------------------------------------


def rx(a: float) -> np.ndarray:
    return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


def ry(a: float) -> np.ndarray:
    return np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def rz(a: float) -> np.ndarray:
    return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])


def naive_limb(angles: np.ndarray, limb: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit directions of upper and lower part of a limb from its angles in degrees (the log format's
    formulae)."""
    s = (1, -1, 1, -1)[limb]
    a = np.radians(angles)
    down = np.array([0.0, -1.0, 0.0])
    if limb < 2:
        r = rz(s * a[0]) @ rx(-a[1]) @ ry(s * a[2])
        return r @ down, r @ rx(-a[3]) @ down
    r = rz(s * a[0]) @ rx(-a[1])
    return r @ down, r @ rx(a[2]) @ down


def performer(seconds: float = 4.0, fps: float = 120.0) -> Motion:
    """A person who waves both arms out of step, steps on the spot, bows and turns."""
    t = np.arange(round(seconds * fps)) / fps
    ease = np.sin(np.pi * t / seconds) ** 2
    a = np.zeros((len(t), 17))
    a[:, 0], a[:, 1], a[:, 6] = 60 * ease, 70 * ease * np.sin(2 * t) ** 2, 60 + 50 * np.sin(3 * t)
    a[:, 3], a[:, 4], a[:, 7] = 20 * ease, 90 * ease, 50 + 40 * np.cos(2.3 * t)
    a[:, 9], a[:, 12] = 40 * np.sin(2.5 * t).clip(0), 60 * np.sin(2.5 * t).clip(0)
    a[:, 11], a[:, 13] = 40 * (-np.sin(2.5 * t)).clip(0), 60 * (-np.sin(2.5 * t)).clip(0)
    a[:, 14], a[:, 15] = 60 * ease, 45 * ease
    return puppet.motion(a, fps, name="waves")


CLIP = performer()
DEVELOPMENT = users("unit", "development", 6, 7)


def player(style: str, skill: float = 0.5, k: int = 0) -> User:
    return User(f"{style}-{k}", "development", style, skill, habits(style, skill, np.random.default_rng(k)))


def moving(angles: np.ndarray) -> np.ndarray:
    """(T − 1, 4): whether a limb's angles change between neighbours."""
    return np.stack([(np.diff(angles[:, c], axis=0) != 0).any(axis=1) for c in LIMB_COLUMNS], axis=1)


# users -------------------------------------------------------------------------------------------------


def test_development_and_test_users_are_different_people():
    for experiment in ("one", "two"):
        first, second = (users(experiment, s, 5, 0) for s in ("development", "test"))
        assert not {u.name for u in first} & {u.name for u in second}
        assert not {u.habits for u in first} & {u.habits for u in second}
        assert {u.split for u in second} == {"test"}
    assert not set(users("one", "test", 5, 0)) & set(users("two", "test", 5, 0))
    assert users("one", "test", 5, 0) != users("one", "test", 5, 1)


def test_users_are_the_same_every_time_and_of_all_styles():
    assert users("one", "test", 3, 0) == users("one", "test", 5, 0)[:3]
    assert {u.style for u in users("one", "test", 3, 0)} == set(STYLES)
    assert all(0 <= u.skill <= 1 for u in users("one", "test", 50, 0))


def test_an_unknown_split_is_refused():
    with pytest.raises(InputError, match="'validation'"):
        users("one", "validation", 5)


def test_skill_lessens_every_error():
    worse, better = (habits("hand", s, np.random.default_rng(1)) for s in (0.1, 0.9))
    for name in (
        "amplitude_error",
        "direction_error",
        "placement_error",
        "blur_s",
        "wander",
        "tilt",
        "drift",
    ):
        assert getattr(better, name) < getattr(worse, name)
    assert better.patience > worse.patience and better.arrange > worse.arrange
    assert better.tempo == worse.tempo and better.landmark == worse.landmark  # habits, not skill


def test_pace_of_users_lies_between_half_and_double():
    assert all(0.5 <= u.habits.tempo <= 2 for u in users("one", "development", 100))


ROOT = Path(__file__).parents[2]
TUNING = [p for part in ("src", "tools", "workflow/scripts") for p in sorted((ROOT / part).rglob("*.py"))]
PLAYS = "workflow/scripts/queries.py"  # where the config's experiments are played


def drawn_splits(code: str) -> list[ast.expr | None]:
    """The second argument, `split`, of every call of `users` in a program."""
    found: list[ast.expr | None] = []
    for node in ast.walk(ast.parse(code)):
        name = getattr(node, "func", None)
        if isinstance(node, ast.Call) and "users" in (getattr(name, "id", ""), getattr(name, "attr", "")):
            named = [k.value for k in node.keywords if k.arg == "split"]
            found.append(node.args[1] if len(node.args) > 1 else named[0] if named else None)
    return found


def test_test_users_appear_in_no_tuning_code():
    """Whoever draws users elsewhere than where experiments are played draws development users, by name."""
    drawn = {str(p.relative_to(ROOT)): drawn_splits(p.read_text(encoding="utf-8")) for p in TUNING}
    assert drawn.pop(PLAYS), "the experiments draw no users: this test looks in the wrong place"
    assert "workflow/scripts/puppeteers.py" in {p for p, splits in drawn.items() if splits}
    for path, splits in drawn.items():
        for split in splits:
            assert isinstance(split, ast.Constant) and split.value == "development", path


def test_the_look_for_test_users_sees_them():
    for code in ('users("e", "test", 5)', "p.users('e', split='test', n=5)", "users('e', name, 5)"):
        (split,) = drawn_splits(code)
        assert not (isinstance(split, ast.Constant) and split.value == "development")
    assert drawn_splits("users('e', 'development', 5)")[0].value == "development"


def test_the_configs_experiments_have_five_test_users():
    for path in sorted((ROOT / "config").glob("*.yaml")):
        for experiment in yaml.safe_load(path.read_text(encoding="utf-8")).get("experiments", {}).values():
            assert experiment.get("split", "test") == "test"
            assert path.name == "test.yaml" or experiment.get("users", 5) == 5


def test_every_setting_is_explained():
    """docs/puppeteer.md names each habit, and the figures that skill changes are those of the program."""
    page = (ROOT / "docs" / "puppeteer.md").read_text(encoding="utf-8")
    for field in fields(Habits):
        assert f"| `{field.name}` |" in page, field.name
    for name, (least, most) in _BY_SKILL.items():
        assert f"| `{name}` | {least:g} → {most:g}" in page, name


# the puppet's body -------------------------------------------------------------------------------------


def test_the_puppet_is_as_large_as_printed():
    height = 0.062 + body.TRUNK - body.HIP[1] + body.REACH[2] + 0.013
    assert height == pytest.approx(0.33)
    assert 2 * (body.SHOULDER[0] + body.REACH[0] + 0.022) == pytest.approx(0.44)


@given(st.integers(0, 3), st.lists(st.floats(0, 1), min_size=4, max_size=4))
def test_limbs_point_where_the_formulae_say(limb, shares):
    low, high = body.RANGES[limb].T
    angles = low + (high - low) * np.array(shares)
    q = np.radians(angles)
    place, elbow = np.empty((4, 3)), np.empty((4, 3))
    body._turn(q, body._tip(q[3], body.UPPER[limb], body.LOWER[limb], limb > 1), place)
    body._turn(q, (0.0, -body.UPPER[limb], 0.0), elbow)
    upper, lower = naive_limb(angles if limb < 2 else angles[[0, 1, 3]], limb)
    mirror = [body.SIDE[limb], 1, 1]
    np.testing.assert_allclose(elbow[0] * mirror, body.UPPER[limb] * upper, atol=1e-12)
    np.testing.assert_allclose(
        place[0] * mirror, body.UPPER[limb] * upper + body.LOWER[limb] * lower, atol=1e-12
    )


@given(st.lists(st.floats(-1.5, 1.5), min_size=6, max_size=6))
def test_derivatives_of_a_turn_are_those_of_finite_differences(values):
    q, v = np.array([*values[:3], 0.0]), tuple(values[3:])
    out, more, less = np.empty((4, 3)), np.empty((4, 3)), np.empty((4, 3))
    body._turn(q, v, out)
    for i in range(3):
        step = np.zeros(4)
        step[i] = 1e-6
        body._turn(q + step, v, more)
        body._turn(q - step, v, less)
        np.testing.assert_allclose(out[i + 1], (more[0] - less[0]) / 2e-6, atol=1e-8)


@given(st.lists(st.floats(-2, 2), min_size=9, max_size=9), st.lists(st.floats(-3, 3), min_size=3, max_size=3))
def test_three_equations_are_solved(values, right):
    root = np.array(values).reshape(3, 3)
    matrix, found = root @ root.T + 1e-3 * np.eye(3), np.array(right)
    body._solve(matrix.copy(), found)
    np.testing.assert_allclose(found, np.linalg.solve(matrix, right), rtol=1e-6, atol=1e-9)


def test_hands_and_feet_reach_what_can_be_reached():
    rng = np.random.default_rng(0)
    for limb in (0, 2):
        ranges = np.radians(body.RANGES[limb])
        errors = []
        for _ in range(300):
            q = ranges[:, 0] + (ranges[:, 1] - ranges[:, 0]) * rng.random(4)
            place, elbow = np.empty((4, 3)), np.empty((4, 3))
            body._turn(q, body._tip(q[3], body.UPPER[limb], body.LOWER[limb], limb > 1), place)
            body._turn(q, (0.0, -body.UPPER[limb], 0.0), elbow)
            found = body.settle(
                np.zeros(4), place[0], elbow[0], 0.3, body.UPPER[limb], body.LOWER[limb], limb > 1, ranges
            )
            assert (found >= ranges[:, 0]).all() and (found <= ranges[:, 1]).all()
            back = np.empty((4, 3))
            body._turn(found, body._tip(found[3], body.UPPER[limb], body.LOWER[limb], limb > 1), back)
            errors.append(np.linalg.norm(back[0] - place[0]))
        assert np.mean(np.array(errors) < 0.002) > 0.97


def _follow(hands, held, *, stick=2.5, join=1):
    n = len(hands)
    elbows = np.tile([0.0, -body.UPPER[2], 0.0], (n, 1))
    start = np.array([0.0, 0.3, 0.0, 0.4])
    return body.follow(
        start, hands, elbows, held, join, 0.0, np.radians(stick), body.UPPER[2], body.LOWER[2], True,
        np.radians(body.RANGES[2]),
    )  # fmt: skip


def _foot(q):
    out = np.empty((4, 3))
    body._turn(q, body._tip(q[3], body.UPPER[2], body.LOWER[2], True), out)
    return out[0]


def test_a_joint_sticks_until_it_is_pushed_enough():
    here = np.array([0.0, 0.3, 0.0, 0.4])
    for push, stays in ((1.0, True), (6.0, False)):
        wanted = np.array([_foot(here), *[_foot(here + np.radians([0.0, push, 0.0, 0.0]))] * 20])
        found = _follow(wanted, np.ones(21, dtype=bool))
        assert (found == here).all() == stays
    assert not (_follow(wanted, np.ones(21, dtype=bool), stick=0.0) == here).all()


def test_friction_holds_a_limb_that_nobody_holds():
    wanted = np.linspace([0.0, -0.1, 0.0], [0.1, 0.0, 0.0], 50)
    held = np.zeros(50, dtype=bool)
    held[10:30] = True
    found = _follow(wanted, held)
    assert (found[:10] == found[0]).all() and (found[30:] == found[29]).all()
    assert not (found[10:30] == found[0]).all()


def test_a_limb_that_is_taken_does_not_jump():
    wanted = np.tile([0.08, -0.05, 0.05], (60, 1))
    found = _follow(wanted, np.ones(60, dtype=bool), join=30, stick=0.0)
    assert np.degrees(np.abs(np.diff(found, axis=0))).max() <= 10.0 + 1e-9
    np.testing.assert_allclose(_foot(found[-1]), wanted[-1], atol=0.01)


def test_counts_are_whole_and_inside_the_ranges():
    wild = np.random.default_rng(0).uniform(-400, 400, (200, 17))
    found = body.quantise(wild)
    np.testing.assert_allclose(found / body.STEP, np.round(found / body.STEP), atol=1e-9)
    assert_in_ranges(found)
    inside = body.quantise(np.full((1, 17), 10.0))
    assert np.abs(inside - 10.0).max() <= body.STEP / 2


def assert_in_ranges(angles):
    for limb, columns in enumerate(LIMB_COLUMNS):
        ranges = body.RANGES[limb] if limb < 2 else body.RANGES[limb][[0, 1, 3]]
        assert (angles[:, columns] >= ranges[:, 0]).all() and (angles[:, columns] <= ranges[:, 1]).all()


# who is played when ------------------------------------------------------------------------------------


def test_hands_take_what_is_worth_most():
    places = np.zeros((10, 4, 3)) + body.ROOTS * [5.0, 1.0, 1.0]  # far apart: no pair fits into one hand
    one, two = player("hand").habits, player("stage").habits
    worth = np.array([0.1, 0.5, 0.3, 0.2])
    assert plan.lead(places, worth, one) == [1]
    assert plan.lead(places, worth, two) == [1, 2]
    assert plan.lead(places, worth * [1, 0, 0, 0], two) == [0]
    assert plan.lead(places, worth * 0, two) == []


def test_one_hand_holds_both_feet_while_they_go_together():
    t = np.linspace(0, 1, 30)[:, None, None]
    places = np.tile(body.ROOTS * [5.0, 1.0, 1.0], (30, 1, 1))
    places[:, 2:, 0] = [0.024, -0.024]
    together = places + t * np.array([0.0, 0.1, 0.0])
    worth = np.array([0.3, 0.0, 0.25, 0.25])
    assert plan.lead(together, worth, player("hand").habits) == [2, 3]
    apart = together.copy()
    apart[:, 2] += t[:, 0] * [0.0, 0.0, 0.08]
    assert plan.lead(apart, worth, player("hand").habits) == [0]
    # two hands could hold three limbs then, but nobody can move three
    assert len(plan.lead(together, worth, player("stage").habits)) == 2


@given(st.integers(1, 400), st.integers(0, 5))
def test_phrases_cover_a_clip(n, k):
    paths = np.cumsum(np.random.default_rng(k).normal(size=(n, 4, 3)), axis=0)
    found = plan.phrases(paths)
    assert found[0][0] == 0 and found[-1][1] == n - 1
    assert all(a[1] == b[0] for a, b in pairwise(found))
    if len(found) > 1:
        assert min(b - a for a, b in found) >= plan.PHRASE_S * 60


@pytest.mark.parametrize("style", STYLES)
def test_a_time_line_never_goes_back_but_for_limbs_that_had_to_wait(style):
    seen = imitation.watch(CLIP, 0.0)
    for k in range(5):
        h = replace(player(style, 0.8, k).habits, second_pass=0.0)
        clock, held = plan.timeline(seen.shown, seen.paths, h, np.random.default_rng(k))
        assert (np.diff(clock[:, 4]) >= 0).all() and clock[-1, 4] == len(seen.paths) - 1
        assert held.sum(axis=1).max() <= 2
        assert not held[0].any() and not held[-1].any()
        pace = np.diff(clock[:, 4])
        assert 0.25 < pace[pace > 0].mean() < 2.5


def test_limbs_that_waited_play_a_second_pass_with_the_trunk():
    seen = imitation.watch(CLIP, 0.0)
    h = replace(player("hand", 0.8).habits, second_pass=1.0, care=0.0)
    clock, held = plan.timeline(seen.shown, seen.paths, h, np.random.default_rng(0))
    trunk_clock, last = clock[:, 4], len(seen.paths) - 1
    back = np.flatnonzero(np.diff(trunk_clock) < 0)
    assert len(back) and trunk_clock[back[-1] + 1] == 0 and trunk_clock[-1] == last
    assert not held[back + 1].any()  # nobody plays while the trunk goes back
    second = held[back[-1] + 1 :].any(axis=0)
    assert second.any() and held.sum(axis=1).max() <= 2
    assert (clock[-1, :4][second] == last).all()


@pytest.mark.parametrize("style", STYLES)
def test_limbs_are_put_where_the_clip_begins_before_the_log_or_in_it(style):
    a = np.zeros((240, 17))
    a[:, [1, 4]] = 90.0  # both arms forward throughout, a leg kicks
    a[:, 9] = 60 * np.sin(np.linspace(0, np.pi, 240))
    clip = puppet.motion(a, 60.0)
    for arrange in (0.0, 1.0):
        user = player(style, 0.7)
        user = replace(user, habits=replace(user.habits, arrange=arrange, placement_error=0.0, amplitude=0.0))
        angles, _ = imitate(clip, user, seed_parts=("first",))
        at_once = np.abs(angles[0, [1, 4]] - 90.0) < 45
        assert at_once.all() == bool(arrange) and at_once.any() == bool(arrange)
        middle = np.abs(angles[len(angles) // 2 :, [1, 4]] - 90.0)
        assert (middle < 50).all()


@given(st.floats(0.05, 1.0), st.floats(-0.3, 0.3), st.floats(0.0, 1.0))
def test_the_error_of_a_straight_limbs_length_is_felt(there, error, share):
    down = np.array([0.0, -1.0, 0.0])
    meant = np.broadcast_to(body.REACH[:, None] * there * down, (1, 4, 3))
    wanted = meant * (1 + error)
    bend = 2 * np.arccos(min(there, 1.0))  # of a limb of two equal parts
    counts = min(max(np.sin(bend / 2) / 0.5, share), 1.0)
    expected = meant * (1 + counts * error)
    np.testing.assert_allclose(imitation._felt(meant, wanted, share), expected, atol=1e-12)


# the trunk ---------------------------------------------------------------------------------------------


@given(st.lists(st.floats(-3, 3), min_size=3, max_size=3))
def test_heading_and_tilt_make_the_rotation(angles):
    r = Rotation.from_euler("YXZ", angles)
    heading, tilt = trunk.heading_and_tilt(r.as_matrix()[None])
    back = Rotation.from_rotvec(tilt[0]) * Rotation.from_rotvec([0.0, heading[0], 0.0])
    assert (back * r.inv()).magnitude() < 1e-6
    assert abs(tilt[0, 1]) < 1e-6


def test_a_stage_tilts_a_little_and_a_hand_follows():
    frames = Rotation.from_rotvec(np.outer(np.linspace(0, np.pi / 2, 240), [1.0, 0.0, 0.0])).as_matrix()
    last = {}
    for style in ("hand", "stage"):
        h = replace(player(style).habits, tilt=0.0, drift=0.0, shake=0.0, amplitude=0.0, amplitude_error=0.0)
        user = replace(player(style), habits=h)
        turned = trunk.carry(frames, np.arange(240.0), (10, 230), user, np.random.default_rng(0))
        last[style] = np.degrees(np.linalg.norm(Rotation.from_matrix(turned[-1]).as_rotvec()))
    assert last["hand"] == pytest.approx(90, abs=3)
    assert last["stage"] <= 20.5


@pytest.mark.parametrize("style", STYLES)
def test_a_flip_does_not_tear_the_trunk(style):
    frames = Rotation.from_rotvec(np.outer(np.linspace(0, 2 * np.pi, 120), [-1.0, 0.0, 0.0])).as_matrix()
    for k in range(4):
        turned = Rotation.from_matrix(
            trunk.carry(frames, np.arange(120.0), (5, 110), player(style, 0.3, k), np.random.default_rng(k))
        )
        assert np.degrees((turned[1:] * turned[:-1].inv()).magnitude()).max() < 20


# logs --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("user", DEVELOPMENT, ids=lambda u: f"{u.name}-{u.style}")
def test_a_log_keeps_the_puppets_bounds(user):
    angles, fps = imitate(CLIP, user, seed_parts=("bounds",))
    assert fps == 60 and angles.shape[1] == 17 and np.isfinite(angles).all()
    np.testing.assert_allclose(angles / body.STEP, np.round(angles / body.STEP), atol=1e-9)
    assert_in_ranges(angles)
    assert abs(angles[0, 14]) <= body.STEP  # a puppet knows no north


@pytest.mark.parametrize("user", DEVELOPMENT, ids=lambda u: f"{u.name}-{u.style}")
def test_at_most_two_limbs_move_at_once(user):
    for k in range(4):
        busy = moving(imitate(CLIP, user, seed_parts=("two", k))[0])
        assert busy.sum(axis=1).max() <= 2
        assert busy.any()


def test_one_hand_moves_one_arm_at_a_time():
    arms = moving(imitate(CLIP, player("hand", 0.7), seed_parts=(1,))[0])[:, :2]
    assert arms.any() and not arms.all(axis=1).any()


@pytest.mark.parametrize("style", STYLES)
def test_hands_reach_in_and_let_go(style):
    user = player(style, 0.4)
    angles, _ = imitate(CLIP, user, seed_parts=("ends",))
    still = ~moving(angles).any(axis=1)
    first, last = np.flatnonzero(~still)[[0, -1]]
    least = 0.3 * user.habits.reach_in_s * 60 - 2
    assert first >= least and len(still) - 1 - last >= least


def test_unimportant_limbs_are_left_still():
    a = np.zeros((300, 17))
    a[:, 1] = 90 * np.sin(np.linspace(0, 2 * np.pi, 300)) ** 2
    a[:, 4] = 5 * np.sin(np.linspace(0, 2 * np.pi, 300)) ** 2
    found, _ = imitate(puppet.motion(a, 60.0), player("stage", 0.6), seed_parts=(0,))
    assert moving(found).any(axis=0).tolist() == [True, False, False, False]


@pytest.mark.parametrize("style", STYLES)
def test_the_same_seed_gives_the_same_log(style):
    user = player(style)
    one, two, other = (imitate(CLIP, user, seed_parts=p)[0] for p in (("a", 1), ("a", 1), ("a", 2)))
    assert one.tobytes() == two.tobytes()
    assert one.shape != other.shape or (one != other).any()


def test_the_formulae_and_the_reader_see_the_same_puppet():
    angles, fps = imitate(CLIP, player("strapped"), seed_parts=("fk",))
    p = puppet.motion(angles, fps).positions()
    where = find_joints(PERSON)
    for t in range(0, len(angles), 25):
        yaw, pitch, roll = np.radians(angles[t, 14:])
        r = ry(yaw) @ rx(pitch) @ rz(roll)
        for limb, (root, middle, end) in enumerate(body.PARTS):
            upper, lower = naive_limb(angles[t, LIMB_COLUMNS[limb]], limb)
            for direction, a, b in ((upper, root, middle), (lower, middle, end)):
                bone = p[t, where[b]] - p[t, where[a]]
                np.testing.assert_allclose(bone / np.linalg.norm(bone), r @ direction, atol=1e-9)


def test_a_log_is_written_and_read(tmp_path):
    angles, fps = imitate(CLIP, player("stage"), seed_parts=("file",))
    puppet.write_log(tmp_path / "q.csv", angles, fps, simulated=True)
    assert puppet.is_simulated(tmp_path / "q.csv")
    back = puppet.read(tmp_path / "q.csv")
    np.testing.assert_allclose(back.positions(), puppet.motion(angles, fps).positions(), atol=1e-3)


# how well they play ------------------------------------------------------------------------------------


def directions(motion: Motion) -> np.ndarray:
    """(T, 4, 3): unit directions from shoulder to hand and hip to foot in the world."""
    p, where = motion.positions(), find_joints(motion.skeleton)
    ways = np.stack([p[:, where[e]] - p[:, where[r]] for r, _, e in body.PARTS], axis=1)
    return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


def degrees_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip((a * b).sum(axis=-1), -1, 1)))


def flawless(**changes: float) -> User:
    return User("perfect", "development", "hand", 1.0, replace(perfect(), **changes))


def test_a_perfect_user_reproduces_where_hands_and_feet_point():
    angles, fps = imitate(CLIP, flawless(), seed_parts=())
    clock, _ = plan.timeline(
        *(lambda s: (s.shown, s.paths))(imitation.watch(CLIP, 0.0)), perfect(), np.random.default_rng(0)
    )
    assert len(clock) == len(angles)
    target = directions(CLIP)[:: round(CLIP.fps / 60)]
    target = target[np.round(clock[:, :4]).astype(int), np.arange(4)]
    found = directions(puppet.motion(angles, fps))
    later = slice(round(plan.JOIN_S * 60), None)
    error = degrees_apart(found, target)[later]
    assert np.median(error) < 1.5 and np.quantile(error, 0.95) < 6


def test_less_skill_is_worse():
    """Nearest pose of the target for each pose that is played: a distance that pauses and pace do not
    touch."""
    target = directions(CLIP)[::4]
    error = {}
    for skill in (0.0, 0.5, 1.0):
        found = []
        for k in range(12):
            user = player(STYLES[k % 3], skill, k)
            played = directions(puppet.motion(*imitate(CLIP, user, seed_parts=(k,))))[::4]
            found.append(degrees_apart(played[:, None], target[None]).mean(axis=-1).min(axis=1).mean())
        error[skill] = np.mean(found)
    assert error[0.0] > error[0.5] > error[1.0] > 3


@pytest.mark.parametrize(
    "setting",
    [
        {"amplitude_error": 0.5},
        {"direction_error": 40.0},
        {"placement_error": 0.3},
        {"wander": 0.02},
        {"drift": 15.0},
    ],
    ids=lambda s: next(iter(s)),
)
def test_each_error_alone_is_worse_than_none(setting):
    plays = [
        directions(puppet.motion(*imitate(CLIP, flawless(**s), seed_parts=("one",)))) for s in ({}, setting)
    ]
    assert plays[0].shape == plays[1].shape
    assert np.median(degrees_apart(*plays)) > 2


def test_all_habits_are_said_to_be_something():
    source = Path(imitation.__file__).with_name("users.py").read_text(encoding="utf-8")
    for name in Habits.__dataclass_fields__:
        kind = Habits.__dataclass_fields__[name].type
        assert f'    {name}: {kind}\n    """' in source, f"{name} has no description"


# odd clips ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("frames", [1, 2, 3, 40])
@pytest.mark.parametrize("style", STYLES)
def test_short_and_still_clips_are_played(frames, style):
    still = puppet.motion(np.zeros((frames, 17)), 30.0)
    angles, _ = imitate(still, player(style), seed_parts=(frames,))
    assert np.isfinite(angles).all()
    assert_in_ranges(angles)


def test_an_empty_clip_is_refused():
    with pytest.raises(InputError, match="no frames"):
        imitate(CLIP[0:0], DEVELOPMENT[0], seed_parts=())


def test_a_clip_of_someone_without_a_body_is_refused():
    from miburi.figures import HAND

    hand = Motion(HAND, 30.0, np.zeros((3, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (3, 16, 1)))
    with pytest.raises(InputError):
        imitate(hand, DEVELOPMENT[0], seed_parts=())


# real clips --------------------------------------------------------------------------------------------


def clips(recordings: Path, every: int) -> dict[str, Motion]:
    folder = recordings / "body_hdm05"
    found = sorted(folder.glob("*/*.amc.gz"))[::every]
    return {
        f"{p.parent.name}/{p.name[:6]}": read(p, skeleton=folder / "asf" / f"{p.name[:2]}.asf.gz")
        for p in found
    }


def test_real_clips_are_played_and_neither_too_well_nor_at_random(recordings):
    from miburi.retrieval import Index, features, reset_angles

    corpus = clips(recordings, 4)
    values = [reset_angles(features(m)) for m in corpus.values()]
    index = Index.build(values, [(name, i, 0, len(values[i])) for i, name in enumerate(corpus)])
    ranks = []
    for user in users("difficulty", "development", 3, 0):
        for i, (name, target) in list(enumerate(corpus.items()))[::6]:
            angles, fps = imitate(target, user, seed_parts=(name,))
            assert_in_ranges(angles)
            assert moving(angles).sum(axis=1).max() <= 2
            order = index.rank(reset_angles(features(puppet.motion(angles, fps)))).order
            ranks.append(int(np.flatnonzero(order == i)[0]) + 1)
    chance = (len(corpus) + 1) / 2
    assert 1.2 < np.mean(ranks) < 0.5 * chance
    assert np.mean(np.array(ranks) == 1) < 0.9


def test_all_thirteen_joints_are_seen(recordings):
    target = next(iter(clips(recordings, 100).values()))
    seen = imitation.watch(target, 0.0)
    assert np.isfinite(seen.paths).all() and set(BODY_JOINTS) <= set(find_joints(target.skeleton))
    assert (np.linalg.norm(seen.paths, axis=-1) <= body.REACH * 1.02).all()
    # hands and feet hang below shoulders and hips for most of any clip that begins upright
    assert (seen.paths[0, :, 1] < 0).all()
