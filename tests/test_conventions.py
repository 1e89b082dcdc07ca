"""Joints found by name are where such joints are."""

import numpy as np
import pytest

from miburi.conventions import CONVENTIONS, REQUIRED, family, find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, PERSON
from miburi.formats import asf_amc, bvh
from miburi.motion import Motion, Skeleton

BODIES = {
    "bandai_namco": "Bandai-Namco", "biovision_classic": "Biovision", "blender_rigify": "Blender Rigify",
    "blender_ue_names": "Unreal", "cmu_animated_drawings": "Xsens, Mocapbank, SMPL, OpenNI",
    "cmu_asf_names": "Acclaim (CMU, HDM05)", "cmu_daz_friendly": "DAZ, Poser",
    "cmu_lfingers": "MotionBuilder", "cmu_motionbuilder": "MotionBuilder",
    "fair_optical": "MotionBuilder", "geno_bind": "MotionBuilder", "geno_stance": "MotionBuilder",
    "iclone_cc_base": "iClone, 3ds Max Biped", "kinect_openni": "Xsens, Mocapbank, SMPL, OpenNI",
    "lafan1_names": "MotionBuilder", "makehuman_default": "MakeHuman",
    "makehuman_face_poseunits": "MakeHuman", "makehuman_old": "MakeHuman (old)",
    "mixamo": "MotionBuilder", "mocapbank": "Xsens, Mocapbank, SMPL, OpenNI",
    "motionbuilder_moda": "MotionBuilder", "perception_neuron_axis": "MotionBuilder",
    "pfnn_hierarchy": "MotionBuilder", "rokoko_studio": "MotionBuilder",
    "smpl_names": "Xsens, Mocapbank, SMPL, OpenNI", "spine3_xzy": "MotionBuilder",
    "vicon_fingers": "MotionBuilder", "xsens_mvn": "Xsens, Mocapbank, SMPL, OpenNI",
    "xsens_mvn_crlf": "Xsens, Mocapbank, SMPL, OpenNI",
}  # fmt: skip
NOT_BODIES = {
    "chain_without_end_site", "odd_frames_line_wrong", "odd_simple", "oddity_frame_time_digits",
    "oddity_rotation_first_root",
}  # fmt: skip


def check_geometry(motion: Motion, alike: float = 0.12) -> None:
    """A person: left is left, bones have a person's lengths, joints stand above each other."""
    j = find_joints(motion.skeleton)
    p = motion[:: max(1, len(motion) // 20)].positions()
    at = {name: p[:, k] for name, k in j.items()}

    def length(a: str, b: str) -> float:
        return float(np.median(np.linalg.norm(at[a] - at[b], axis=1)))

    for s in "lr":
        assert 0.25 < length(f"{s}_hip", f"{s}_knee") < 0.6
        assert 0.25 < length(f"{s}_knee", f"{s}_foot") < 0.6
        assert 0.15 < length(f"{s}_shoulder", f"{s}_elbow") < 0.45
        assert 0.12 < length(f"{s}_elbow", f"{s}_hand") < 0.4
        assert length(f"{s}_shoulder", "neck") < 0.35
        assert length(f"{s}_hip", "waist") < 0.45
    for a, b in (("shoulder", "elbow"), ("elbow", "hand"), ("hip", "knee"), ("knee", "foot")):
        assert length(f"l_{a}", f"l_{b}") == pytest.approx(length(f"r_{a}", f"r_{b}"), rel=alike)
    assert 0.05 < length("l_hip", "r_hip") < 0.4
    assert 0.2 < length("l_shoulder", "r_shoulder") < 0.6
    assert 0.15 < length("waist", "neck") < 0.7
    up = np.array([0, 1, 0])
    assert np.median((at["neck"] - at["waist"]) @ up) > 0.15
    for s in "lr":  # most of the time the knee is below the hip and the ankle below the knee
        assert np.median((at[f"{s}_hip"] - at[f"{s}_knee"]) @ up) > 0.05
        assert np.median((at[f"{s}_knee"] - at[f"{s}_foot"]) @ up) > 0.05
    # forward is where the toes point: it must be left × up for the hips and the shoulders alike
    forward = np.mean([_toes(motion, p, j[f"{s}_foot"]) - at[f"{s}_foot"] for s in "lr"], axis=0)
    for pair in ("hip", "shoulder"):
        across = at[f"l_{pair}"] - at[f"r_{pair}"]
        ahead = np.cross(across, at["neck"] - at["waist"])
        if np.median(np.linalg.norm(forward[:, [0, 2]], axis=1)) > 0.05:  # two figures have no toes
            assert np.mean(np.sum(ahead * forward, axis=1) > 0) > 0.75, pair
    sides = np.sum((at["l_hip"] - at["r_hip"]) * (at["l_shoulder"] - at["r_shoulder"]), axis=1)
    assert np.median(sides) > 0


def _toes(motion: Motion, p: np.ndarray, foot: int) -> np.ndarray:
    """The joint or end below an ankle that is farthest from it."""
    s = motion.skeleton
    below = [foot]
    for joint, parent in enumerate(s.parents):
        if parent in below:
            below.append(joint)
    tips = motion[:: max(1, len(motion) // 20)].end_positions()[:, np.isin(s.ends, below)]
    points = np.concatenate([p[:, below], tips], axis=1)
    far = np.median(np.linalg.norm(points - p[:, None, foot], axis=2), axis=0)
    return points[:, np.argmax(far)]


@pytest.mark.parametrize("name", BODIES)
def test_every_convention_on_a_real_body(recordings, name):
    motion = bvh.read(recordings / "formats" / f"{name}.bvh.gz")
    assert str(family(motion.skeleton)).startswith(BODIES[name])
    # a depth camera sees one arm shorter than the other
    check_geometry(motion, alike=0.7 if name == "kinect_openni" else 0.12)


def test_no_file_is_forgotten(recordings):
    there = {p.name.removesuffix(".bvh.gz") for p in (recordings / "formats").glob("*.bvh.gz")}
    assert there == set(BODIES) | NOT_BODIES


@pytest.mark.parametrize("name", ["01_01", "05_13", "14_14", "86_01"])
def test_acclaim_bodies(recordings, name):
    check_geometry(asf_amc.read(recordings / "body" / "cmu" / f"{name}.amc.gz"))


def test_the_same_joints_in_the_acclaim_and_biovision_files_of_a_take(recordings):
    amc = asf_amc.read(recordings / "body/cmu/02_01.amc.gz").skeleton
    mb = bvh.read(recordings / "body/cmu_bvh/02_01.bvh.gz").skeleton
    ours = {n: amc.joints[k] for n, k in find_joints(amc).items()}
    theirs = {n: mb.joints[k] for n, k in find_joints(mb).items()}
    assert ours["neck"] == "lowerneck" and theirs["neck"] == "Neck"
    assert ours["l_hand"] == "lwrist" and theirs["l_hand"] == "LeftHand"
    assert ours["l_foot"] == "lfoot" and theirs["l_foot"] == "LeftFoot"


def named(*joints: str) -> Skeleton:
    n = len(joints)
    return Skeleton(joints, np.array([-1] + [0] * (n - 1)), np.zeros((n, 3)), "s")


@pytest.mark.parametrize(
    "prefix", ["", "mixamorig:", "mixamorig7:", "Beta:", "Model_", "Bip01_", "ns:rig:", "Char7_", "X.Y_"]
)
def test_prefixes_do_not_matter(prefix):
    plain = "Hips Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm RightForeArm "
    plain += "RightHand LeftUpLeg LeftLeg LeftFoot RightUpLeg RightLeg RightFoot"
    found = find_joints(named(*(prefix + n for n in plain.split())))
    assert [plain.split()[found[j]] for j in BODY_JOINTS[:3]] == ["Neck", "LeftArm", "RightArm"]


def test_a_shoulder_beside_an_arm_is_a_collar_bone_and_beside_an_elbow_an_arm():
    xsens = "Hips Neck LeftShoulder LeftElbow LeftWrist RightShoulder RightElbow RightWrist LeftHip LeftKnee "
    s = named(*(xsens + "LeftAnkle RightHip RightKnee RightAnkle").split())
    assert s.joints[find_joints(s)["l_shoulder"]] == "LeftShoulder"


def test_our_own_person():
    assert {n: PERSON.joints[k] for n, k in find_joints(PERSON).items()} == {n: n for n in PERSON.joints}


def test_every_convention_has_every_joint():
    for c in CONVENTIONS:
        assert all("*" in getattr(c, part) for part in ("shoulder", "elbow", "hand", "hip", "knee", "foot"))
        names = [getattr(c, p).split()[0] for p in ("waist", "neck")]
        for side in c.sides:
            names += [getattr(c, p).split()[0].replace("*", side) for p in c._fields[5:]]
        assert set(find_joints(named(*names))) == set(REQUIRED)


def test_a_missing_joint_lists_what_there_is_and_can_be_named():
    names = [n.replace("_", "-") for n in PERSON.joints if n != "l_knee"]
    s = named(*names, "Knie links")
    with pytest.raises(InputError, match=r"known as l_knee; it has waist, neck, .*Knie links: .*`joints`"):
        find_joints(s)
    assert find_joints(s, {"l_knee": "Knie links"})["l_knee"] == 13
    with pytest.raises(InputError, match="has no joint 'Knie rechts'"):
        find_joints(s, {"l_knee": "Knie rechts"})
    with pytest.raises(InputError, match=r"joints\.knee: there is no such joint"):
        find_joints(s, {"knee": "Knie links"})


def test_helpers_are_not_joints():
    names = [f"__{n}" for n in PERSON.joints[1:]]
    with pytest.raises(InputError):
        find_joints(named("waist", *names))
