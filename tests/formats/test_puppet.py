"""Puppet logs: against the conventions written out, uneven clocks, raw counts, and what is refused."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi.errors import InputError
from miburi.figures import PERSON
from miburi.formats import puppet, read
from miburi.kinematics import forward, yaw_pitch_roll

from . import naive

SAMPLES = Path(__file__).parents[2] / "data" / "samples" / "puppet"
DOWN = np.array([0.0, -1.0, 0.0])


def twin(row):
    """Directions of the limbs of one frame, by the conventions' own words."""
    v = dict(zip(puppet.COLUMNS, row, strict=True))
    rot = lambda axis, degrees: naive.about(axis, degrees)[:3, :3]  # noqa: E731
    trunk = rot("y", v["imu_yaw"]) @ rot("x", v["imu_pitch"]) @ rot("z", v["imu_roll"])
    limbs = {"trunk": trunk @ -DOWN}
    for side, s in (("l", 1), ("r", -1)):
        arm = rot("z", s * v[f"{side}_shoulder_z"]) @ rot("x", -v[f"{side}_shoulder_x"])
        arm = trunk @ arm @ rot("y", s * v[f"{side}_shoulder_y"])
        thigh = trunk @ rot("z", s * v[f"{side}_hip_z"]) @ rot("x", -v[f"{side}_hip_x"])
        limbs[f"{side}_shoulder", f"{side}_elbow"] = arm @ DOWN
        limbs[f"{side}_elbow", f"{side}_hand"] = arm @ rot("x", -v[f"{side}_elbow_x"]) @ DOWN
        limbs[f"{side}_hip", f"{side}_knee"] = thigh @ DOWN
        limbs[f"{side}_knee", f"{side}_foot"] = thigh @ rot("x", v[f"{side}_knee_x"]) @ DOWN
    return limbs


@given(st.lists(st.floats(-170, 170), min_size=17, max_size=17))
def test_angles_become_the_limbs_of_the_conventions(row):
    p = puppet.motion([row], 60).positions()[0]
    for bone, direction in twin(row).items():
        a, b = ("waist", "neck") if bone == "trunk" else bone
        d = p[PERSON.index(b)] - p[PERSON.index(a)]
        np.testing.assert_allclose(d / np.linalg.norm(d), direction, atol=1e-9)


def test_signs_are_a_person_s():
    """A forward flexed arm points forward, abducted limbs away from the body, the knee bends backwards."""
    base = dict.fromkeys(puppet.COLUMNS, 0.0)

    def at(joint, **angles):
        p = puppet.motion([list((base | angles).values())], 60).positions()[0]
        return p[PERSON.index(joint)] - p[PERSON.index(joint.split("_")[0] + "_shoulder")]

    assert at("l_hand", l_shoulder_x=90)[2] > 0.5 and at("r_hand", r_shoulder_x=90)[2] > 0.5
    assert at("l_hand", l_shoulder_z=90)[0] > 0.5 and at("r_hand", r_shoulder_z=90)[0] < -0.5
    assert at("l_hand", l_elbow_x=90)[2] > 0.2
    # the forearm points forward: outward rotation turns it away from the midline
    assert at("l_hand", l_elbow_x=90, l_shoulder_y=60)[0] > 0.2
    assert at("r_hand", r_elbow_x=90, r_shoulder_y=60)[0] < -0.2
    assert at("l_foot", l_hip_z=40)[0] > 0.1 and at("r_foot", r_hip_x=60)[2] > 0.3
    assert at("l_foot", l_knee_x=90)[2] < -0.2
    # yaw turns to the left, pitch leans forward, roll to the right
    neck = PERSON.index("neck")
    lean = lambda **a: puppet.motion([list((base | a).values())], 60).positions()[0, neck]  # noqa: E731
    assert lean(imu_pitch=30)[2] > 0.1 and lean(imu_roll=30)[0] < -0.1
    turned = puppet.motion([list((base | {"imu_yaw": 90.0}).values())], 60)
    np.testing.assert_allclose(forward(turned)[1][0, 0] @ [0, 0, 1], [1, 0, 0], atol=1e-12)


def test_the_trunk_s_angles_come_back():
    row = np.zeros((1, 17))
    row[0, 14:] = (25, -10, 5)
    found = np.degrees(yaw_pitch_roll(forward(puppet.motion(row, 60))[1][:, 0]))
    np.testing.assert_allclose(found, row[:, 14:], atol=1e-9)


def test_real_logs(recordings):
    logs = sorted((recordings / "puppet").glob("*.csv"))
    assert len(logs) == 11
    for path in logs:
        motion = read(path)
        rows = [line.split(",") for line in path.read_text().split("\n")[2:] if line]
        seconds = float(rows[-1][0]) - float(rows[0][0])
        assert motion.fps == 60 and len(motion) == pytest.approx(seconds * 60 + 1, abs=1)
        assert motion.skeleton is PERSON and not motion.root.any()


@pytest.mark.parametrize("fps", [60, 29.97, 120])
def test_what_is_written_is_read_again(tmp_path, fps):
    angles = np.round(np.random.default_rng(0).uniform(-90, 90, (100, 17)), 2)
    angles[:, 14] = np.linspace(0, 90, 100).round(2)  # a yaw that does not wrap
    puppet.write_log(tmp_path / "a.csv", angles, fps, simulated=True, user="u1")
    motion = read(tmp_path / "a.csv")
    assert motion.fps == fps and len(motion) == 100
    np.testing.assert_allclose(motion.positions(), puppet.motion(angles, fps).positions(), atol=1e-9)
    assert puppet.is_simulated(tmp_path / "a.csv")
    puppet.write_log(tmp_path / "b.csv", angles, fps)
    assert not puppet.is_simulated(tmp_path / "b.csv")
    puppet.write_log(tmp_path / "c.csv", angles, fps)
    assert (tmp_path / "b.csv").read_bytes() == (tmp_path / "c.csv").read_bytes()


def test_raw_counts_and_an_uneven_clock():
    motion = read(SAMPLES / "raw_counts.csv")
    lines = (SAMPLES / "raw_counts.csv").read_text().split("\n")[2:-1]
    rows = np.array([[float(v) for v in line.split(",")] for line in lines])
    assert len(rows) == 30 and len(motion) == 31  # 0.505 s at 60 Hz
    at = np.arange(31) / 60
    elbow = np.interp(at, rows[:, 0], 0.29326 * (rows[:, 7] - 102))
    other = np.interp(at, rows[:, 0], -0.29326 * (rows[:, 8] - 922))
    yaw = np.interp(at, rows[:, 0], np.degrees(np.unwrap(np.radians(rows[:, 15]))))
    angles = np.zeros((31, 17))
    angles[:, [0, 3]] = 5
    angles[:, 4] = np.interp(at, rows[:, 0], rows[:, 5])
    angles[:, 6], angles[:, 7], angles[:, 14] = elbow, other, yaw
    np.testing.assert_allclose(motion.positions(), puppet.motion(angles, 60).positions(), atol=1e-9)
    # the yaw crosses 180 degrees: no turn the other way round
    assert np.abs(np.diff(yaw)).max() < 3


LOG = (SAMPLES / "point.csv").read_text()
RAW = (SAMPLES / "raw_counts.csv").read_text()
BAD = {
    "column": (LOG, ",imu_roll", ",imu_rol", "there is no column 'imu_rol' in a puppet log"),
    "value missing": (LOG, "\n0.0333,", "\n0.0333", "line 5: 17 values, expected 18"),
    "no number": (LOG, "\n0.0333,5.00", "\n0.0333,five", "line 5: column 'l_shoulder_z' is 'five'"),
    "nan": (LOG, "\n0.0333,5.00", "\n0.0333,nan", "line 5: column 'l_shoulder_z' is 'nan'"),
    "time stands": (
        LOG,
        "\n0.0333,",
        "\n0.0167,",
        "line 5: the time 0.0167 s does not follow 0.0167 s in line 4",
    ),
    "time back": (LOG, "\n0.0333,", "\n0.01,", "line 5: the time 0.01 s does not follow"),
    "time jumps": (LOG, "\n0.7333,", "\n99999999,", "line 47: the clock jumps by 1e+08 s"),
    "no rate": (LOG, ", fps=60", "", "line 1: it does not say fps="),
    "both": (RAW, "r_elbow_x_adc", "l_elbow_x", "the columns 'l_elbow_x' and 'l_elbow_x_adc' are both there"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_refused_names_line_or_column(tmp_path, name):
    log, old, new, message = BAD[name]
    assert old in log
    (tmp_path / "a.csv").write_text(log.replace(old, new, 1))
    (tmp_path / "p.yaml").write_text((SAMPLES / "puppet.yaml").read_text())
    with pytest.raises(InputError) as error:
        read(tmp_path / "a.csv")
    assert message in str(error.value) and "a.csv" in str(error.value)


def test_a_whole_column_that_is_missing(tmp_path):
    rows = [",".join(line.split(",")[:-1]) if k else line for k, line in enumerate(LOG.rstrip().split("\n"))]
    (tmp_path / "a.csv").write_text("\n".join(rows))
    with pytest.raises(InputError, match="the column 'imu_roll' is missing"):
        read(tmp_path / "a.csv")
    rows = [line.split(",", 1)[1] if k else line for k, line in enumerate(LOG.rstrip().split("\n"))]
    (tmp_path / "a.csv").write_text("\n".join(rows))
    with pytest.raises(InputError, match="the column 'time_s' is missing"):
        read(tmp_path / "a.csv")


def test_the_calibration(tmp_path):
    (tmp_path / "a.csv").write_text(RAW)
    with pytest.raises(InputError, match="its calibration is missing"):
        read(tmp_path / "a.csv")
    named = SimpleNamespace(calibration=SAMPLES / "puppet.yaml")
    assert len(read(tmp_path / "a.csv", corpus=named)) == 31
    (tmp_path / "p.yaml").write_text("sensors: {l_elbow_x: {gain: 1, offset: x}}")
    with pytest.raises(InputError, match=r"sensors\.l_elbow_x\.offset is 'x', expected a number"):
        read(tmp_path / "a.csv")
    (tmp_path / "p.yaml").write_text("sensors: {l_elbow_x: {gain: 1, offset: 3}}")
    with pytest.raises(InputError, match=r"the key 'sensors\.r_elbow_x' is missing"):
        read(tmp_path / "a.csv")


def test_what_cannot_be_written_is_refused(tmp_path):
    for angles in (np.zeros((3, 16)), np.full((3, 17), np.nan)):
        with pytest.raises(InputError, match="puppet angles of shape"):
            puppet.write_log(tmp_path / "a.csv", angles, 60)
    with pytest.raises(InputError, match="must be one a row and increase"):
        puppet.write_log(tmp_path / "a.csv", np.zeros((3, 17)), 60, time=[0, 0, 1])
    with pytest.raises(InputError, match="the key 'user' of a log cannot be"):
        puppet.write_log(tmp_path / "a.csv", np.zeros((3, 17)), 60, user="a,b")
    assert not list(tmp_path.iterdir())
