"""BVH: against the naive twin, against what is printed about real files, round trips, and what is refused."""

import gzip
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from miburi.errors import InputError
from miburi.figures import HAND, PERSON
from miburi.formats import angles, bvh, numerals, scan
from miburi.kinematics import euler, hand_rotations
from miburi.motion import Motion, Skeleton

from . import naive

SAMPLES = Path(__file__).parents[2] / "data" / "samples"

HEADER = """HIERARCHY
ROOT Hips
{
\tOFFSET 1.0 2.0 3.0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Chest
\t{
\t\tOFFSET 0 10 0
\t\tCHANNELS 3 Yrotation Xrotation Zrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 5 1
\t\t}
\t}
}
MOTION
"""
ROWS = "1 2 3 10 20 30 40 50 60\n4 5 6 -10 -20 -30 -40 -50 -60\n"
GOOD = HEADER + "Frames: 2\nFrame Time: 0.0333333\n" + ROWS


def written(tmp_path, content, name="a.bvh"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def check_against_twin(path, motion, choice, frames=None):
    """Every joint and end is where the naive twin has it."""
    places = naive.bvh(path)
    basis = {"y": np.eye(3), "z": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])}[choice.up]
    found = motion.positions()
    for j, name in enumerate(motion.skeleton.joints):
        np.testing.assert_allclose(
            found[:frames, j], places[name][:frames] * choice.unit @ basis.T, atol=1e-9
        )
    tips = motion.end_positions()
    for e, j in enumerate(motion.skeleton.ends):
        if np.sum(motion.skeleton.ends == j) == 1:
            expected = places[motion.skeleton.joints[j] + "/end"][:frames] * choice.unit @ basis.T
            np.testing.assert_allclose(tips[:frames, e], expected, atol=1e-9)


VARIANTS = {
    "plain": GOOD,
    "crlf": GOOD.replace("\n", "\r\n"),
    "cr": GOOD.replace("\n", "\r"),
    "no final newline": GOOD.rstrip(),
    "trailing blanks": GOOD.replace("\n", " \t \n"),
    "blank lines": GOOD.replace("\n", "\n\n"),
    "exponents": GOOD.replace("10 20 30", "1e1 2.0E+1 3000e-2"),
    "tabs": GOOD.replace(" 20 ", "\t20\t"),
    "broken rows": GOOD.replace("30 40", "30\n40"),
    "one line of header": GOOD.replace("{\n", "{ ").replace("\t", " "),
    "lower case": GOOD.replace("Zrotation", "zrotation").replace("JOINT", "Joint"),
    "byte order mark": "\ufeff" + GOOD,
}


@pytest.mark.parametrize("name", VARIANTS)
def test_layouts_of_the_text_do_not_matter(tmp_path, name):
    plain = bvh.read(written(tmp_path, GOOD))
    other = bvh.read(written(tmp_path, VARIANTS[name], "b.bvh"))
    assert other.skeleton.joints == plain.skeleton.joints == ("Hips", "Chest")
    np.testing.assert_array_equal(other.positions(), plain.positions())
    np.testing.assert_array_equal(other.skeleton.end_offsets, plain.skeleton.end_offsets)
    assert other.fps == plain.fps == 30.0


def test_equals_the_naive_twin_and_root_positions_replace_the_offset(tmp_path):
    path = written(tmp_path, GOOD)
    motion, choice = bvh.load(path)
    check_against_twin(path, motion, choice)
    np.testing.assert_allclose(motion.positions()[:, 0], [[0.01, 0.02, 0.03], [0.04, 0.05, 0.06]])
    np.testing.assert_allclose(motion.skeleton.offsets[0], [0.01, 0.02, 0.03])


def test_gzip_is_told_by_content_and_damage_is_named(tmp_path):
    packed = gzip.compress(GOOD.encode())
    for name in ("a.bvh.gz", "b.bvh"):
        assert len(bvh.read(written(tmp_path, packed, name))) == 2
    with pytest.raises(InputError, match="gzip is damaged"):
        bvh.read(written(tmp_path, packed[:-12], "c.bvh.gz"))
    with pytest.raises(InputError, match="not gzipped"):
        bvh.read(written(tmp_path, GOOD, "d.bvh.gz"))


def test_channels_in_any_order_and_number(tmp_path):
    header = GOOD.split("MOTION")[0]
    header = header.replace(
        "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
        "6 Yrotation Zrotation Xrotation Zposition Xposition Yposition",
    ).replace("3 Yrotation Xrotation Zrotation", "4 Xrotation Yposition Zposition Zrotation")
    path = written(tmp_path, header + "MOTION\nFrames: 1\nFrame Time: .04\n1 2 3 4 5 6 7 8 9 10\n")
    motion, choice = bvh.load(path)
    check_against_twin(path, motion, choice)
    assert motion.translations is not None and motion.fps == 25
    # the axis without a position channel keeps its OFFSET
    np.testing.assert_allclose(motion.translations[0, 1], [0.0, -0.02, 0.09])


def test_positions_that_repeat_the_offset_are_dropped(tmp_path):
    header = GOOD.split("MOTION")[0].replace("CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition")
    rows = "1 2 3 0 0 0 0 10 0 5 5 5\n" * 2
    motion = bvh.read(written(tmp_path, header + "MOTION\nFrames: 2\nFrame Time: 0.01\n" + rows))
    assert motion.translations is None
    moving = rows.replace("0 10 0 5", "0 11 0 5", 1)
    path = written(tmp_path, header + "MOTION\nFrames: 2\nFrame Time: 0.01\n" + moving, "b.bvh")
    motion, choice = bvh.load(path)
    assert motion.translations is not None
    check_against_twin(path, motion, choice)


def test_displacements_of_nothing_leave_the_offsets(tmp_path):
    header = GOOD.split("MOTION")[0].replace("CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition")
    rows = "1 2 3 0 0 0 0 0 0 5 5 5\n" * 2
    motion = bvh.read(written(tmp_path, header + "MOTION\nFrames: 2\nFrame Time: 0.01\n" + rows))
    assert motion.translations is None
    np.testing.assert_allclose(motion.positions()[0, 1], [0.01, 0.12, 0.03])


def test_sites_in_disguise_equal_names_and_blanks(tmp_path):
    header = """HIERARCHY
ROOT Left Hip
{
OFFSET 0 0 0
CHANNELS 3 Xrotation Yrotation Zrotation
JOINT Bone {
 OFFSET 0 1 0
 CHANNELS 1 Xrotation
 JOINT Site { OFFSET 0 1 0 CHANNELS 0 }
}
JOINT Bone {
 OFFSET 1 0 0
 CHANNELS 2 Zrotation Xrotation
 JOINT Site { OFFSET 0 2 0 CHANNELS 0 }
}
JOINT End { OFFSET 0 0 1 CHANNELS 0 }
}
MOTION
Frames: 1
Frame Time: 0.05
1 2 3 4 5 6
"""
    motion = bvh.read(written(tmp_path, header))
    assert motion.skeleton.joints == ("Left Hip", "Bone", "Bone.2", "End")
    assert motion.skeleton.ends.tolist() == [1, 2]
    np.testing.assert_allclose(motion.skeleton.end_offsets, [[0, 0.01, 0], [0, 0.02, 0]])


BAD = {
    "no BVH": ("hello\n", "line 1: found 'hello', expected HIERARCHY"),
    "empty": ("", "expected HIERARCHY"),
    "wrong count": (GOOD.replace("Frames: 2", "Frames: 3"), "line 17: Frames: says 3, the file has 2 rows"),
    "one row": (HEADER + "Frames: 9\nFrame Time: 0.1\n1 2 3 4 5 6 7 8 9\n", "says 9, the file has 1 row of"),
    "huge count": (GOOD.replace("Frames: 2", "Frames: 1000000000000"), "says 1000000000000, the file has 2"),
    "no count": (GOOD.replace("Frames: 2", "Frames: two"), "Frames: says 'two', expected a positive"),
    "no frame": (GOOD.replace("Frames: 2", "Frames: 0"), "Frames: says '0'"),
    "no rate": (GOOD.replace("0.0333333", "0"), "line 18: Frame Time: says '0', expected seconds"),
    "tiny rate": (GOOD.replace("0.0333333", "1e-320"), "Frame Time: says"),
    "no motion": (GOOD.split("MOTION")[0], "line 15: the file ends without MOTION"),
    "short row": (GOOD.replace(" 60\n4", "\n4"), "line 19: 8 values, expected 9"),
    "long row": (GOOD.replace(" 60\n4", " 60 70\n4"), "line 19: 10 values, expected 9"),
    "cut in a row": (GOOD[:-12], "line 20: 6 values, expected 9"),
    "word": (GOOD.replace("-20", "minus"), "line 20: 'minus' is not a finite number"),
    "nan": (GOOD.replace("-20", "nan"), "line 20: 'nan' is not a finite number"),
    "inf": (GOOD.replace("-20", "1e999"), "line 20: '1e999' is too large"),
    "underscore": (GOOD.replace("-20", "2_0"), "line 20: '2_0' is not a finite"),
    "hexadecimal": (GOOD.replace("-20", "0x10"), "line 20: '0x10' is not a finite"),
    "cut in the header": (GOOD[: GOOD.index("End Site")], "line 9: the hierarchy ends here"),
    "two roots": (
        GOOD.replace("MOTION", "ROOT Other\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\nMOTION"),
        "a second ROOT 'Other'",
    ),
    "unknown channel": (
        GOOD.replace("Zrotation", "Wrotation", 1),
        "line 5: found 'Wrotation', expected a channel",
    ),
    "channel twice": (
        GOOD.replace("Yposition", "Xposition"),
        "line 5: joint 'Hips' has the channel Xposition twice",
    ),
    "no channels": (
        GOOD.replace("\t\tCHANNELS 3 Yrotation Xrotation Zrotation\n", ""),
        "'Chest' has no CHANNELS",
    ),
    "no offset": (GOOD.replace("\t\tOFFSET 0 10 0\n", ""), "joint 'Chest' has no OFFSET"),
    "short offset": (GOOD.replace("0 10 0", "0 10"), "found 'CHANNELS', expected an OFFSET"),
    "nan offset": (GOOD.replace("0 10 0", "0 nan 0"), "line 8: found 'nan', expected an OFFSET"),
    "nothing moves": (
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 0 }\nMOTION\nFrames: 1000000000\nFrame Time: 1\n\n",
        "nothing moves",
    ),
    "brace missing": (GOOD.replace("\t}\n}\n", "\t}\n"), "the hierarchy ends here"),
    "brace too many": (GOOD.replace("MOTION", "}\nMOTION"), "expected MOTION"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_refused_names_the_line(tmp_path, name):
    content, message = BAD[name]
    with pytest.raises(InputError) as error:
        bvh.read(written(tmp_path, content))
    assert message in str(error.value) and "a.bvh" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_and_a_folder(tmp_path):
    with pytest.raises(InputError, match="there is no such file"):
        bvh.read(tmp_path / "none.bvh")
    (tmp_path / "f.bvh").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        bvh.read(tmp_path / "f.bvh")


@pytest.mark.parametrize(
    ("frame_time", "fps"), [("0.0083333", 120), (".0083333", 120), ("0.008333", 120), ("0.0333333", 30),
    ("0.033333", 30), ("0.04", 25), ("0.016666666666666666", 60), ("0.0417084", 1 / 0.0417084),
    (".0083", 1 / 0.0083), ("4.1667e-02", 24), ("0.008", 125), ("0.03", 1 / 0.03), ("2", 0.5)],
)  # fmt: skip
def test_frame_times_are_rounded_decimals(tmp_path, frame_time, fps):
    assert bvh.read(written(tmp_path, GOOD.replace("0.0333333", frame_time))).fps == fps
    assert bvh.read(written(tmp_path, GOOD), fps=50).fps == 50


# What is printed in the recordings' README: file -> (up, metres per unit)
INCH, CMU = 0.0254, 0.0254 / 0.45
TABLE = {
    "cmu_motionbuilder": ("y", CMU), "cmu_daz_friendly": ("y", 0.01), "cmu_asf_names": ("y", 0.01),
    "cmu_animated_drawings": ("y", CMU), "bandai_namco": ("y", 0.01), "xsens_mvn": ("y", 0.01),
    "xsens_mvn_crlf": ("y", 0.01), "rokoko_studio": ("y", 0.01), "fair_optical": ("z", INCH),
    "mixamo": ("y", 0.01), "mocapbank": ("y", 0.01), "vicon_fingers": ("z", INCH),
    "spine3_xzy": ("z", INCH), "motionbuilder_moda": ("y", INCH), "kinect_openni": ("y", 0.001),
    "smpl_names": ("y", 0.01), "lafan1_names": ("y", 1.0), "biovision_classic": ("y", INCH),
    "blender_rigify": ("y", 0.1), "perception_neuron_axis": ("y", 0.01), "makehuman_default": ("z", 0.1),
    "makehuman_face_poseunits": ("z", 0.1), "makehuman_old": ("z", 0.1), "iclone_cc_base": ("y", 0.01),
    "blender_ue_names": ("z", 1.0), "cmu_lfingers": ("y", CMU), "pfnn_hierarchy": ("y", 1.0),
    "geno_bind": ("y", 0.01), "geno_stance": ("y", 0.01),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLE)
def test_units_and_upward_axes_of_real_files(recordings, name):
    motion, choice = bvh.load(recordings / "formats" / f"{name}.bvh.gz")
    up, unit = TABLE[name]
    assert (choice.up, choice.unit) == (up, pytest.approx(unit))
    assert choice.unit_why and choice.up_why and len(motion) > 0


@pytest.mark.parametrize(
    "name", ["cmu_motionbuilder", "bandai_namco", "fair_optical", "perception_neuron_axis",
    "oddity_rotation_first_root", "chain_without_end_site", "odd_simple", "spine3_xzy", "geno_bind",
    "blender_ue_names", "kinect_openni"],
)  # fmt: skip
def test_real_files_equal_the_naive_twin(recordings, tmp_path, name):
    lines = naive.text_of(recordings / "formats" / f"{name}.bvh.gz").replace("\r", "").rstrip().split("\n")
    at = next(k for k, line in enumerate(lines) if line.strip().startswith("Frames:"))
    kept = min(4, len(lines) - at - 2)
    path = written(tmp_path, "\n".join([*lines[:at], f"Frames: {kept}", *lines[at + 1 : at + 2 + kept]]))
    motion, choice = bvh.load(path)
    check_against_twin(path, motion, choice)


def test_golden_numbers_of_another_reader():
    """Made once with an independent reader: see `meta` in the file."""
    golden = json.loads((Path(__file__).parent / "golden_bvh.json").read_text())
    motion, choice = bvh.load(SAMPLES / golden["file"])
    found = motion.positions()
    for name, places in golden["positions"].items():
        np.testing.assert_allclose(
            found[golden["frames"], motion.skeleton.index(name)], np.array(places) * choice.unit, atol=1e-7
        )


# ---- writing


@st.composite
def motions(draw):
    """Random trees that move at random: any order of joints, any ends, poses at the poles."""
    n = draw(st.integers(1, 7))
    parents = [-1] + [draw(st.integers(0, j - 1)) for j in range(1, n)]
    number = st.floats(-3, 3, allow_nan=False).map(lambda v: round(v, 6))

    def triples(k: int) -> np.ndarray:
        return np.array(draw(st.lists(number, min_size=3 * k, max_size=3 * k))).reshape(k, 3)

    ends = draw(st.lists(st.integers(0, n - 1), max_size=4))
    kinds = draw(st.sampled_from(["body", "wrist thumb middle", "left arm"]))
    names = tuple(f"{kinds} {j}" for j in range(n))
    skeleton = Skeleton(names, np.array(parents), triples(n), "s", np.array(sorted(ends)), triples(len(ends)))
    t = draw(st.integers(1, 3))
    turns = st.sampled_from([0.0, 90.0, -90.0, 180.0, 33.3, -120.5, 1e-7])
    degrees = np.array(draw(st.lists(turns, min_size=3 * n * t, max_size=3 * n * t))).reshape(t, n, 3)
    moved = triples(t * n).reshape(t, n, 3) if draw(st.booleans()) else None
    if moved is not None:
        moved[:, 0] = 0
    fps = draw(st.sampled_from([30.0, 120.0, 23.976, 29.97, 59.94, 1000 / 33, 7.0]))
    return Motion(skeleton, fps, triples(t), euler(degrees, "ZXY"), moved, name="m")


@given(motion=motions(), packed=st.booleans())
@settings(max_examples=80)
def test_what_is_written_is_read_again(tmp_path_factory, motion, packed):
    path = tmp_path_factory.mktemp("w") / ("m.bvh.gz" if packed else "m.bvh")
    bvh.write(path, motion)
    again, choice = bvh.load(path)
    assert (choice.unit, choice.up) == (0.01, "y")
    assert again.fps == pytest.approx(motion.fps, rel=1e-15)
    assert sorted(again.skeleton.joints) == sorted(motion.skeleton.joints)
    order = [again.skeleton.index(j) for j in motion.skeleton.joints]
    np.testing.assert_allclose(again.skeleton.offsets[order], motion.skeleton.offsets, atol=1e-9)
    parents = [-1 if p < 0 else order[p] for p in motion.skeleton.parents]
    assert again.skeleton.parents[order].tolist() == parents
    np.testing.assert_allclose(again.positions()[:, order], motion.positions(), atol=1e-6)
    assert (motion.translations is None) <= (again.translations is None)
    theirs = sorted(
        (order[e], *o) for e, o in zip(motion.skeleton.ends, motion.skeleton.end_offsets, strict=True)
    )
    ours = sorted((int(e), *o) for e, o in zip(again.skeleton.ends, again.skeleton.end_offsets, strict=True))
    np.testing.assert_allclose(np.array(ours), np.array(theirs), atol=1e-9)
    # rotations too, as matrices: q and −q are the same
    dots = np.abs(np.sum(again.rotations[:, order] * motion.rotations, axis=-1))
    np.testing.assert_allclose(dots, 1, atol=1e-9)
    # writing is deterministic
    bvh.write(path.with_name("n" + path.name), motion)
    assert path.with_name("n" + path.name).read_bytes() == path.read_bytes()


def test_hands_and_puppets_keep_their_size(tmp_path):
    small = replace(PERSON, offsets=PERSON.offsets * 0.19, end_offsets=PERSON.end_offsets * 0.19)
    for skeleton in (HAND, PERSON, small):
        rest = Motion(skeleton, 30, np.zeros((2, 3)), np.tile([0, 0, 0, 1.0], (2, len(skeleton), 1)))
        bvh.write(tmp_path / "a.bvh", rest)
        again = bvh.read(tmp_path / "a.bvh")
        assert again.skeleton.joints == skeleton.joints
        np.testing.assert_allclose(again.skeleton.offsets, skeleton.offsets, atol=1e-9)
        np.testing.assert_array_equal(again.skeleton.ends, skeleton.ends)
        np.testing.assert_allclose(again.positions(), rest.positions(), atol=1e-6)


def test_written_files_are_valid_for_the_naive_twin(tmp_path):
    """Other readers do not know our mark: the same places without it."""
    angles_ = np.random.default_rng(0).uniform(-60, 60, (3, 48))
    motion = Motion(HAND, 30, np.zeros((3, 3)), hand_rotations(angles_))
    bvh.write(tmp_path / "a.bvh", motion)
    places = naive.bvh(tmp_path / "a.bvh")
    for j, name in enumerate(HAND.joints):
        np.testing.assert_allclose(places[name] / 100, motion.positions()[:, j], atol=1e-6)


def test_names_that_cannot_be_written_are_refused_and_nothing_is_left(tmp_path):
    bad = Skeleton(("a{b",), np.array([-1]), np.zeros((1, 3)))
    with pytest.raises(InputError, match="cannot be named so"):
        bvh.write(tmp_path / "a.bvh", Motion(bad, 1, np.zeros((1, 3)), np.array([[[0, 0, 0, 1.0]]])))
    with pytest.raises(InputError, match="no frames"):
        bvh.write(tmp_path / "a.bvh", Motion(PERSON, 1, np.zeros((0, 3)), np.zeros((0, 14, 4))))
    assert not list(tmp_path.iterdir())


@given(
    st.lists(st.floats(-1e6, 1e6) | st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=40)
)
def test_numbers_are_rounded_as_python_rounds_them(values):
    for form in ("{!r}", "{:.6f}", "{:.3e}", "{:g}"):
        tokens = [form.format(v) for v in values]
        expected = np.array([float(t) for t in tokens])
        if np.isfinite(expected).all():
            found = scan.numbers("t", " ".join(tokens).encode(), 0, len(values))[0]
            np.testing.assert_array_equal(found, expected)
            assert (np.signbit(found) == np.signbit(expected)).all()


@given(st.lists(st.floats(-400, 400), min_size=9, max_size=9), st.permutations("xyz"))
def test_rotations_are_products_in_the_order_given(values, order):
    q = angles.rotations(
        np.array([values]),
        np.array([[0, 4, 8], [2, -1, -1]]),
        np.array([["xyz".index(a) for a in order], [1, 0, 0]]),
    )
    m = np.eye(4)
    for axis, column in zip(order, (0, 4, 8), strict=True):
        m = m @ naive.about(axis, values[column])
    np.testing.assert_allclose(Rotation.from_quat(q[0, 0]).as_matrix(), m[:3, :3], atol=1e-12)
    np.testing.assert_allclose(
        Rotation.from_quat(q[0, 1]).as_matrix(), naive.about("y", values[2])[:3, :3], atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.norm(q, axis=-1), 1, atol=1e-12)


@given(arrays(np.float64, (7, 3), elements=st.floats(-1e8, 1e8)), st.sampled_from([1.0, 1e-9, 1e5]))
def test_numbers_are_written_as_percent_formatting_does(table: np.ndarray, scale: float) -> None:
    table = table * scale
    got = [line.split(" ") for line in numerals.six(table).decode().splitlines()]
    for row, words in zip(table.tolist(), got, strict=True):
        for value, word in zip(row, words, strict=True):
            twin = f"{value:.6f}"
            assert len(word.partition(".")[2]) == 6 and word != "-0.000000"
            assert word == twin or abs(float(word) - value) <= 1e-6 + 1e-15 * abs(value)
