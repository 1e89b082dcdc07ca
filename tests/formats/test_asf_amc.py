"""Acclaim: against the naive twin, against public conversions of the same takes, and what is refused."""

import gzip
import shutil
from pathlib import Path

import numpy as np
import pytest

from miburi.errors import InputError
from miburi.formats import asf_amc, bvh
from miburi.motion import Skeleton

from . import naive

SAMPLES = Path(__file__).parents[2] / "data" / "samples"
CMU = 0.0254 / 0.45


def check_against_twin(asf, amc, motion, first=None):
    places = naive.acclaim(asf, amc, first)
    found = motion.positions() / CMU
    for j, name in enumerate(motion.skeleton.joints):
        np.testing.assert_allclose(found[:first, j], places[name], atol=1e-9, err_msg=name)
    tips = motion.end_positions() / CMU
    for e, j in enumerate(motion.skeleton.ends):
        np.testing.assert_allclose(tips[:first, e], places[motion.skeleton.joints[j] + "/tail"], atol=1e-9)


def test_the_sample_equals_the_naive_twin():
    motion = asf_amc.read(SAMPLES / "figure_01.amc")
    assert len(motion) == 12 and motion.fps == 120 and motion.name == "figure_01"
    assert motion.skeleton.joints == ("root", "trunk", "neck", "larm", "lforearm", "lthigh", "lfixed")
    assert motion.skeleton.name == "figure" and len(motion.skeleton.ends) == 3
    check_against_twin(SAMPLES / "figure.asf", SAMPLES / "figure_01.amc", motion)


def test_limits_and_freedom_of_bones():
    bones = {b.name: b for b in asf_amc.read_asf(SAMPLES / "figure.asf").bones}
    assert bones["lthigh"].dof == ("rx", "ry", "rz") and bones["neck"].dof == ("rz", "rx")
    assert bones["lthigh"].limits == ((-160, 20), (-70, 70), (-60, 70))
    assert bones["larm"].limits[1] == (-np.inf, np.inf) and bones["lfixed"].dof == ()


@pytest.mark.parametrize("take", ["01_01", "02_01", "05_13", "14_14", "86_01"])
def test_real_takes_equal_the_naive_twin(recordings, take):
    folder = recordings / "body" / "cmu"
    motion = asf_amc.read(folder / f"{take}.amc.gz")
    assert len(motion.skeleton) == 31
    check_against_twin(folder / f"{take[:2]}.asf", folder / f"{take}.amc.gz", motion, first=3)


LOWER_BODY = {
    "root": "Hips", "lfemur": "LeftUpLeg", "ltibia": "LeftLeg", "lfoot": "LeftFoot", "ltoes": "LeftToeBase",
    "rfemur": "RightUpLeg", "rtibia": "RightLeg", "rfoot": "RightFoot", "rtoes": "RightToeBase",
    "lowerback": "LowerBack", "upperback": "Spine", "thorax": "Spine1",
}  # fmt: skip
UPPER_BODY = {
    "lowerneck": "Neck", "upperneck": "Neck1", "head": "Head", "lhumerus": "LeftArm",
    "lradius": "LeftForeArm", "lwrist": "LeftHand", "rhumerus": "RightArm", "rradius": "RightForeArm",
    "rwrist": "RightHand",
}  # fmt: skip


@pytest.mark.parametrize("take", [f"02_{k:02d}" for k in range(1, 11)])
def test_public_conversions_differ_only_by_the_thorax(recordings, take):
    """Legs agree to 0.01 mm; the conversion leaves the thorax out, so all above it is its length too low."""
    amc = asf_amc.read(recordings / f"body/cmu/{take}.amc.gz")
    other = bvh.read(recordings / f"body/cmu_bvh/{take}.bvh.gz")[1:]  # its first frame is a rest pose
    assert len(amc) == len(other)
    ours, theirs = amc.positions(), other.positions()
    # the conversions scale by 0.0564444: the rest of 1/0.45 inch is below a micrometre
    apart = {
        a: np.linalg.norm(ours[:, amc.skeleton.index(a)] - theirs[:, other.skeleton.index(b)], axis=1)
        for a, b in (LOWER_BODY | UPPER_BODY).items()
    }
    for a in LOWER_BODY:
        assert apart[a].max() < 1e-5, a
    thorax = np.linalg.norm(amc.skeleton.offsets[amc.skeleton.index("lowerneck")])
    assert 0.1165 < thorax < 0.119  # 117 to 119 mm in the recordings' README
    for a in UPPER_BODY:
        np.testing.assert_allclose(apart[a], thorax, atol=1e-5, err_msg=a)
    # too low: the difference points along the thorax, upwards while the person stands
    up = ours[:, amc.skeleton.index("lowerneck"), 1] - theirs[:, other.skeleton.index("Neck"), 1]
    assert np.median(up) > 0.08


def test_14_14_agrees_with_its_conversion_in_the_legs(recordings):
    amc = asf_amc.read(recordings / "body/cmu/14_14.amc.gz")
    other = bvh.read(recordings / "body/cmu_bvh/14_14.bvh.gz")
    assert len(amc) == len(other) == 4653
    ours, theirs = amc.positions(), other.positions()
    for a, b in (
        ("lfemur", "LeftHip"),
        ("ltibia", "LeftKnee"),
        ("rfoot", "RightAnkle"),
        ("ltoes", "LeftToe"),
    ):
        d = np.linalg.norm(ours[:, amc.skeleton.index(a)] - theirs[:, other.skeleton.index(b)], axis=1)
        assert d.max() < 1.1e-5


def test_written_as_bvh_and_read_again(recordings, tmp_path):
    motion = asf_amc.read(recordings / "body/cmu/02_01.amc.gz")
    bvh.write(tmp_path / "a.bvh.gz", motion)
    again = bvh.read(tmp_path / "a.bvh.gz")
    assert again.skeleton.joints == motion.skeleton.joints and again.fps == 120
    np.testing.assert_allclose(again.positions(), motion.positions(), atol=1e-6)


@pytest.fixture
def folder(tmp_path):
    for name in ("figure.asf", "figure_01.amc"):
        shutil.copy(SAMPLES / name, tmp_path)
    return tmp_path


LAYOUTS = {
    "crlf": lambda s: s.replace("\n", "\r\n"),
    "cr": lambda s: s.replace("\n", "\r"),
    "no final newline": str.rstrip,
    "indented": lambda s: s.replace("\nneck", "\n  neck"),
    "blank lines": lambda s: s.replace("\nneck", "\n\nneck"),
    "tabs": lambda s: s.replace("neck ", "neck\t"),
    "trailing blanks": lambda s: s.replace("\n", "  \n"),
    "comments": lambda s: s.replace("\nneck", "\n# odd\nneck", 3),
    "other order in a frame": lambda s: swapped(s),
    "only one header line": lambda s: s.replace(":FULLY-SPECIFIED\n", ""),
}


def swapped(s):
    """Two bones of the last frame change places."""
    lines = s.rstrip().split("\n")
    lines[-1], lines[-2] = lines[-2], lines[-1]
    return "\n".join(lines)


@pytest.mark.parametrize("name", LAYOUTS)
def test_layouts_of_the_text_do_not_matter(folder, name):
    plain = asf_amc.read(folder / "figure_01.amc")
    (folder / "figure_02.amc").write_text(LAYOUTS[name]((folder / "figure_01.amc").read_text()), newline="")
    other = asf_amc.read(folder / "figure_02.amc")
    np.testing.assert_array_equal(other.rotations, plain.rotations)
    np.testing.assert_array_equal(other.root, plain.root)


def test_radians_rates_and_latin_1(folder):
    plain = asf_amc.read(folder / "figure_01.amc")
    lines = []
    for line in (folder / "figure_01.amc").read_text().split("\n"):
        words = line.split()
        if words and words[0].isalpha():
            k = 4 if words[0] == "root" else 1
            words[k:] = [repr(float(np.radians(float(w)))) for w in words[k:]]
            line = " ".join(words)
        lines.append(line)
    content = "#!OML:ASF F:\\für Bonn\\a.ASF\n:SAMPLES-PER-SECOND 60\n" + "\n".join(lines).replace(
        "DEGREES", "RADIANS"
    )
    (folder / "figure_02.amc.gz").write_bytes(gzip.compress(content.encode("latin-1")))
    other = asf_amc.read(folder / "figure_02.amc.gz")
    assert other.fps == 60 and asf_amc.read(folder / "figure_02.amc.gz", fps=100).fps == 100
    np.testing.assert_allclose(other.positions(), plain.positions(), atol=1e-12)
    asf = (folder / "figure.asf").read_text().replace("angle deg", "angle rad")
    for words in ("10 20 30  ZYX", "-90 7.6e-016 20  XYZ", "90 0 0  XYZ", "0 0 20  XYZ"):
        values = " ".join(repr(float(np.radians(float(w)))) for w in words.split()[:3])
        asf = asf.replace(f"axis {words}", f"axis {values} {words.split()[3]}")
    (folder / "r.asf").write_text(asf)
    same = asf_amc.read(folder / "figure_01.amc", skeleton=folder / "r.asf")
    np.testing.assert_allclose(same.positions(), plain.positions(), atol=1e-12)


def test_translating_bones_move(folder):
    asf = (
        (folder / "figure.asf")
        .read_text()
        .replace("dof rz rx\n    limits (-45.0 45.0)\n", "dof tx ty rz rx\n")
    )
    asf = asf.replace("dof tx ty rz rx\n           (-45.0 45.0)\n", "dof tx ty rz rx\n")
    (folder / "figure.asf").write_text(asf)
    amc = (folder / "figure_01.amc").read_text().replace("\nneck ", "\nneck 1 2 ")
    (folder / "figure_01.amc").write_text(amc)
    motion = asf_amc.read(folder / "figure_01.amc")
    assert motion.translations is not None
    j = motion.skeleton.index("neck")
    np.testing.assert_allclose(np.linalg.norm(motion.translations[:, j], axis=1), np.sqrt(5) * CMU)
    assert not motion.translations[:, [0, 1, 3, 4, 5, 6]].any()


def test_where_the_skeleton_is_looked_for(folder):
    amc = folder / "figure_01.amc"
    (folder / "figure.asf").rename(folder / "only.asf")
    assert asf_amc.find_asf(amc).name == "only.asf"
    (folder / "other.asf").write_text((folder / "only.asf").read_text())
    with pytest.raises(
        InputError, match=r"looked for figure\.asf and figure\.asf\.gz in .*, which has 2 others"
    ):
        asf_amc.read(amc)
    assert len(asf_amc.read(amc, skeleton=folder / "other.asf")) == 12
    assert len(asf_amc.read(amc, skeleton=asf_amc.read_asf(folder / "other.asf"))) == 12
    (folder / "figure.asf.gz").write_bytes(gzip.compress((folder / "only.asf").read_bytes()))
    assert asf_amc.find_asf(amc).name == "figure.asf.gz"
    with pytest.raises(InputError, match="does not hold the axes"):
        asf_amc.read(amc, skeleton=Skeleton(("a",), np.array([-1]), np.zeros((1, 3))))


def test_units(folder):
    plain = asf_amc.read(folder / "figure_01.amc")
    other = asf_amc.read(folder / "figure_01.amc", unit=1.0)
    np.testing.assert_allclose(other.positions() * CMU, plain.positions(), atol=1e-12)


BAD_AMC = {
    "value missing": (
        "lforearm 4",
        "lforearm",
        "line 9: joint 'lforearm' has 0 values, its skeleton figure gives it 1",
    ),
    "value too many": (
        "\nneck ",
        "\nneck 1 ",
        "line 7: joint 'neck' has 3 values, its skeleton figure gives it 2",
    ),
    "unknown joint": ("\nneck", "\nnick", "line 7: joint 'nick' is not in its skeleton figure"),
    "no number": ("-2.5e+000", "?", "line 6: '?' is not a finite number"),
    "nan": ("-2.5e+000", "nan", "line 6: 'nan' is not a finite number"),
    "joint twice": ("\nneck ", "\nlthigh 1 2 3\nneck ", "joint 'lthigh' stands twice in a frame"),
    "header": (":DEGREES", ":GRADES", "line 3: found ':GRADES', expected :FULLY-SPECIFIED"),
}


@pytest.mark.parametrize("name", BAD_AMC)
def test_what_is_refused_in_an_amc_names_the_line(folder, name):
    old, new, message = BAD_AMC[name]
    amc = folder / "figure_01.amc"
    content = amc.read_text()
    if name == "value missing":
        content = "\n".join("lforearm" if k == 8 else line for k, line in enumerate(content.split("\n")))
    else:
        assert old in content
        content = content.replace(old, new)
    amc.write_text(content)
    with pytest.raises(InputError) as error:
        asf_amc.read(amc)
    assert message in str(error.value)


def test_a_joint_that_is_missing_or_damaged_later_on(folder):
    amc = folder / "figure_01.amc"
    lines = amc.read_text().rstrip().split("\n")

    def refused(changed, message):
        amc.write_text("\n".join(changed) + "\n")
        with pytest.raises(InputError) as error:
            asf_amc.read(amc)
        assert message in str(error.value)

    refused(lines[:-1], "line 86: frame 12 ends without 'lthigh'")  # cut at the end of a line
    refused([*lines[:-1], lines[-1][:10]], "joint 'lthigh' has 1 value")
    refused([*lines[:20], *lines[21:]], "ends without 'neck'")
    refused([*lines[:17], "7", *lines[18:]], "line 18: frame 7 follows frame 2")
    refused(lines[:3], "line 3: the file ends before the first frame")
    refused([*lines[:-2], lines[-2].replace("lforearm ", "lforearm x"), lines[-1]], "line 86: 'x")
    refused(
        [line for line in lines if not line.startswith("neck")],
        "the frames have no 'neck', which the skeleton moves",
    )


BAD_ASF = {
    "not an ASF": (None, "hello\n", "line 1: found 'hello', expected a section"),
    "empty": (None, "", "the file ends without :root"),
    "no hierarchy": (":hierarchy", ":skin", "the file ends without :hierarchy"),
    "length": ("length 2.0", "length two", "line 31: found 'two', expected the length of 'neck'"),
    "direction": ("direction 0 1 0\n", "direction 0 1\n", "expected the direction of 'neck': 3 numbers"),
    "axis": ("30  ZYX", "30  ZZX", "expected the axis of 'neck'"),
    "freedom": ("dof rz rx", "dof rz rq", "bone 'neck' has the degree of freedom 'rq'"),
    "freedom twice": ("dof rz rx", "dof rz rz", "bone 'neck' has the degree of freedom 'rz'"),
    "stretch": ("dof rz rx", "dof rz l", "bone 'neck' changes its length"),
    "limits": ("(-20.0 45.0)", "(-20.0)", "bone 'trunk' has the limits"),
    "no name": ("name neck", "nome neck", "bone '?' has no name"),
    "name twice": ("name neck", "name larm", "bone 'larm' stands twice"),
    "two parents": ("trunk neck larm", "trunk neck larm lthigh", "bone 'lthigh' has two parents"),
    "loop": ("root trunk lthigh", "larm trunk lthigh", "does not hang on the root"),
    "unknown child": ("trunk neck larm", "trunk neck rarm", "the hierarchy names 'rarm'"),
    "not in the tree": ("larm lforearm", "larm", "bone 'lforearm' is not in the hierarchy"),
    "units": ("angle deg", "angle gon", "the angle of :units is 'gon'"),
    "scale": ("length 0.45", "length 0", "the length of :units is 0.0"),
    "not closed": ("  end\n:hierarchy", ":hierarchy", "end in the middle of a bone"),
    "order": ("order TX TY", "order TX TX", "the root's order is"),
}


@pytest.mark.parametrize("name", BAD_ASF)
def test_what_is_refused_in_an_asf_names_the_file(folder, name):
    old, new, message = BAD_ASF[name]
    asf = folder / "figure.asf"
    content = asf.read_text()
    assert old is None or old in content
    asf.write_text(new if old is None else content.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        asf_amc.read_asf(asf)
    assert message in str(error.value) and "figure.asf" in str(error.value)
