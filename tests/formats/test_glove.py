"""Glove logs and other loggers' tables: against a slow twin, on real gloves, and what is refused."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from miburi.errors import InputError
from miburi.figures import HAND
from miburi.formats import columns, glove, read, read_labels

SAMPLES = Path(__file__).parents[2] / "data" / "samples" / "glove"
MAPS = Path(__file__).parents[2] / "config" / "gloves"


def twin(log: Path, calibration: Path) -> np.ndarray:
    """The angles of a log, one value after the other."""
    sensors = yaml.safe_load(calibration.read_text())["sensors"]
    lines = log.read_text().split("\n")
    names = lines[1].split(",")[1:]
    frames = []
    for line in lines[2:-1]:
        row = np.zeros(48)
        for name, count in zip(names, line.split(",")[1:], strict=True):
            s = sensors[name]
            if not s:
                continue
            angle = s["gain"] * (int(count) - s["offset"])

            def add(joint, axis, share, row=row, angle=angle):
                row[3 * HAND.joints.index(joint) + "zxy".index(axis)] += share * angle

            if isinstance(s["joint"], list):
                for joint, share in zip(s["joint"], s.get("weights", [0.5, -0.5]), strict=True):
                    add(joint, s["axis"], share)
            else:
                add(s["joint"], s["axis"], 1.0)
            for more in s.get("also", []):
                add(more["joint"], more["axis"], more["factor"])
        frames.append(row)
    return np.array(frames)


def test_a_log_equals_the_twin():
    motion = read(SAMPLES / "fist.csv")
    assert motion.skeleton is HAND and motion.fps == 30 and len(motion) == 60
    expected = twin(SAMPLES / "fist.csv", SAMPLES / "wearer.yaml")
    np.testing.assert_allclose(motion.angles, expected, atol=1e-12)
    assert np.ptp(expected, axis=0).max() > 50
    # half to each of two fingers, with opposite signs
    z = [3 * HAND.index(j) for j in ("middle1", "index1")]
    spread = -0.5 * (
        90 - 120
    )  # sensor 5 in the fist; sensor 19, which moves middle1 too, rests at its offset
    np.testing.assert_allclose(motion.angles[25, z], [spread / 2, -spread / 2])


def palm_distances(motion):
    """Millimetres from each fingertip to the middle of the palm: (T, 5)."""
    p = motion.positions()
    knuckles = p[:, [HAND.index(f"{f}1") for f in ("index", "middle", "ring", "little")]].mean(axis=1)
    palm = 0.6 * knuckles + 0.4 * p[:, 0]
    return 1000 * np.linalg.norm(motion.end_positions() - palm[:, None], axis=2)


def test_a_fist_is_a_fist():
    d = palm_distances(read(SAMPLES / "fist.csv"))
    assert d[:10, 1:].min() > 100 and d[25:35, 1:].max() < 60
    # the fingertips come to the palm's side of the hand
    assert read(SAMPLES / "fist.csv").end_positions()[30, 1:, 2].min() > 0


def test_real_rock_paper_scissors(recordings):
    folder = recordings / "hand" / "cyberglove_rps"
    corpus = SimpleNamespace(columns=str(MAPS / "cyberglove_rps.yaml"))
    motion = read(folder / "mock.txt.gz", corpus=corpus)
    assert len(motion) == 300 and motion.fps == 24
    d = palm_distances(motion)
    labels = read_labels(folder / "labels.tsv", fps=24, frames=300)
    assert labels == read_labels(folder / "labels_exclusive.tsv", fps=24, frames=300)
    hold = {k: np.concatenate([d[a:b] for a, b, label in labels if label == k]).mean(axis=0) for k in "rps"}
    assert (hold["r"][1:] < 70).all() and (hold["p"][1:] > 100).all()
    assert (hold["s"][1:3] > 120).all() and (hold["s"][3:] < 85).all()
    report = {s.name: s for s in glove.sensor_report(folder / "mock.txt.gz", corpus.columns)}
    assert [n for n, s in report.items() if s.dead] == ["5", "6"]
    assert report["7"].saturated > 0.5 and report["8"].saturated < 0.2


@pytest.mark.parametrize("sign", "SABV")
def test_real_postures_of_two_more_gloves(recordings, sign):
    """S and A are fists, B a flat hand, V two fingers: a CyberGlove, and another maker's quaternions."""
    import gzip

    hand = recordings / "hand"
    libras = hand / "libras_cyberglove" / "alphabet+numbers.csv.gz"
    rows = gzip.decompress(libras.read_bytes()).decode().split("\r")[1:]
    signs = np.array([row.split(",")[-1] for row in rows if row.strip()])
    postures = read(libras, corpus=SimpleNamespace(columns=MAPS / "cyberglove_sdk.yaml"))
    assert len(postures) == len(signs) == 3100
    quaternions = hand / "rokoko_signs" / f"{sign}.csv.gz"
    other = read(quaternions, corpus=SimpleNamespace(columns=MAPS / "rokoko_smartglove.yaml"))
    for d in (palm_distances(postures)[signs == sign].mean(axis=0), palm_distances(other).mean(axis=0)):
        closed = {"S": d[1:], "A": d[1:], "B": d[:0], "V": d[3:]}[sign]
        straight = {"S": d[:0], "A": d[:0], "B": d[1:], "V": d[1:3]}[sign]
        assert (closed < 75).all() and (straight > 100).all()


def test_real_quaternions_have_the_angles_of_their_readme(recordings):
    corpus = SimpleNamespace(columns=MAPS / "rokoko_smartglove.yaml")
    for sign, pip, mcp in (("S", 104, 87), ("B", 15, 27), ("V", 10, 69)):
        a = read(recordings / "hand" / "rokoko_signs" / f"{sign}.csv.gz", corpus=corpus).angles.mean(axis=0)
        # the README has whole angles, the map the part of them that is flexion
        assert a[3 * HAND.index("index2") + 1] == pytest.approx(pip, abs=4)
        assert a[3 * HAND.index("ring1") + 1] == pytest.approx(mcp, abs=4)


def test_real_tables_of_other_layouts(recordings):
    hand = recordings / "hand"
    lying = read(
        hand / "cyberglove3_timing" / "Joint_Angle_Data_radian.csv.gz",
        corpus=SimpleNamespace(columns=MAPS / "cyberglove3.yaml"),
    )
    # 10 000 polls in 14.25 s become 60 frames a second
    assert lying.fps == 60 and len(lying) == 856
    for path in sorted((hand / "graspdb14").glob("*-su0?.txt.gz")):
        motion = read(path, corpus=SimpleNamespace(columns=MAPS / "graspdb14.yaml"))
        assert motion.fps == 60 and len(motion) > 200
    calibration = read(
        hand / "graspdb14" / "00_calib-rad-su01.txt.gz",
        corpus=SimpleNamespace(columns=MAPS / "graspdb14.yaml"),
    )
    assert len(calibration) == 6674
    a = calibration.angles.reshape(-1, 16, 3)[:, HAND.index("ring2"), 1]
    assert (a.min(), a.max()) == (pytest.approx(-24, abs=1.5), pytest.approx(137, abs=1))
    blanks = hand / "libras_cyberglove" / "gesture_23.txt.gz"
    assert len(read(blanks, corpus=SimpleNamespace(columns=MAPS / "cyberglove_sdk_blanks.yaml"))) == 10


def test_every_ready_map_is_valid():
    for path in MAPS.glob("*.yaml"):
        assert columns.load(path)["columns"]


def test_a_table_by_hand(tmp_path):
    """Decimal commas, an offset in the file's unit, CRLF."""
    table = {
        "fps": 24, "separator": ":", "decimal": ",", "count": 3, "unit": "radians",
        "columns": [{"column": 0, "joint": "index1", "axis": "x", "factor": -2, "offset": 0.1},
                    {"column": 1, "joint": ["middle1", "index1"], "axis": "z"}],
    }  # fmt: skip
    motion = read(SAMPLES / "other_logger.txt", corpus=SimpleNamespace(columns=table))
    k = np.arange(20)
    i, m = 3 * HAND.index("index1"), 3 * HAND.index("middle1")
    np.testing.assert_allclose(motion.angles[:, i + 1], np.degrees(-2 * (-0.02 * k - 0.1)), atol=1e-9)
    np.testing.assert_allclose(motion.angles[:, m], np.degrees(0.5 - 0.01 * k) / 2, atol=1e-9)
    np.testing.assert_allclose(motion.angles[:, i], -motion.angles[:, m], atol=1e-12)
    assert read(SAMPLES / "other_logger.txt", fps=50, corpus=SimpleNamespace(columns=table)).fps == 50


def test_an_uneven_clock_is_made_even(tmp_path):
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.005, 0.02, 200))
    rows = "\n".join(f"{t:.6f} {90 * t:.6f}" for t in time)
    (tmp_path / "a.txt").write_text(rows)
    table = {"fps": 50, "time": {"column": 0}, "columns": [{"column": 1, "joint": "index1", "axis": "x"}]}
    motion = read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=table))
    assert len(motion) == int((time[-1] - time[0]) * 50 + 1e-6) + 1
    x = motion.angles[:, 3 * HAND.index("index1") + 1]
    np.testing.assert_allclose(np.diff(x), 90 / 50, atol=1e-4)


@pytest.mark.parametrize(("maximum", "simulated"), [(255, False), (4095, True)])
def test_what_is_written_is_read_again(tmp_path, maximum, simulated):
    counts = np.random.default_rng(1).integers(0, maximum + 1, (50, 22))
    glove.write_log(tmp_path / "a.csv", counts, 29.97, maximum=maximum, simulated=simulated, wearer="w1")
    fps, names, again, most = glove.read_counts(tmp_path / "a.csv")
    assert (fps, most, names[0], names[-1]) == (29.97, maximum, "s01", "s22")
    np.testing.assert_array_equal(again, counts)
    first = (tmp_path / "a.csv").read_text().split("\n")[0]
    assert ("simulated=1" in first) == simulated and "wearer=w1" in first


def test_sensors_that_are_dead_or_saturated_are_reported_not_refused(tmp_path):
    counts = np.random.default_rng(1).integers(1, 255, (100, 22))
    counts[:, 3] = 77
    counts[:40, 5] = 255
    counts[:20, 6] = 0
    glove.write_log(tmp_path / "a.csv", counts, 30)
    report = {s.name: s for s in glove.sensor_report(tmp_path / "a.csv")}
    assert [n for n, s in report.items() if s.dead] == ["s04"]
    assert (report["s06"].saturated, report["s07"].saturated, report["s01"].saturated) == (0.4, 0.2, 0)


LOG = (SAMPLES / "fist.csv").read_text()
BAD_LOG = {
    "signature": ("glove log 1", "glove log 2", "line 1: is neither a glove log nor a puppet log"),
    "no rate": ("fps=30, ", "", "line 1: it does not say fps="),
    "rate": ("fps=30", "fps=fast", "fps in line 1 is 'fast'"),
    "key twice": ("fps=30", "fps=30, fps=30", "line 1: found 'fps=30', expected key=value, each key once"),
    "column": (",s22", "", "line 2: 21 columns of sensors, line 1 says 22"),
    "renamed": (",s22", ",x", "line 2: the column 's22' is missing"),
    "twice": (",s22", ",s21", "line 2: the column 's21' stands twice"),
    "first column": ("frame,", "time,", "line 2: the first column is 'time'"),
    "value missing": ("\n3,100,", "\n3,", "line 6: 22 values, expected 23"),
    "value empty": ("\n3,100,", "\n3,,", "line 6: column 's01' is ''"),
    "no number": ("\n3,100,", "\n3,1o0,", "line 6: column 's01' is '1o0', expected a finite number"),
    "nan": ("\n3,100,", "\n3,nan,", "line 6: column 's01' is 'nan'"),
    "too high": ("\n3,100,", "\n3,256,", "line 6: column 's01' is 256, expected a whole count from 0 to 255"),
    "negative": ("\n3,100,", "\n3,-1,", "line 6: column 's01' is -1"),
    "half": ("\n3,100,", "\n3,1.5,", "line 6: column 's01' is 1.5"),
    "gap": ("\n3,", "\n4,", "line 6: frame 4 follows frame 2"),
}


@pytest.mark.parametrize("name", BAD_LOG)
def test_what_is_refused_in_a_log_names_line_and_column(tmp_path, name):
    old, new, message = BAD_LOG[name]
    assert old in LOG
    (tmp_path / "a.csv").write_text(LOG.replace(old, new, 1))
    (tmp_path / "w.yaml").write_text((SAMPLES / "wearer.yaml").read_text())
    with pytest.raises(InputError) as error:
        read(tmp_path / "a.csv")
    assert message in str(error.value) and "a.csv" in str(error.value)


def test_an_empty_log(tmp_path):
    (tmp_path / "a.csv").write_text("\n".join(LOG.split("\n")[:2]) + "\n")
    with pytest.raises(InputError, match="ends before its first row"):
        read(tmp_path / "a.csv")


def test_where_the_calibration_is_looked_for(tmp_path):
    (tmp_path / "a.csv").write_text(LOG)
    with pytest.raises(InputError, match=r"expected one \.yaml in .*, there is none; .*`calibration`"):
        read(tmp_path / "a.csv")
    for name in ("b.yaml", "c.yaml"):
        (tmp_path / name).write_text((SAMPLES / "wearer.yaml").read_text())
    with pytest.raises(InputError, match=r"there are b\.yaml, c\.yaml"):
        read(tmp_path / "a.csv")
    named = SimpleNamespace(calibration=str(tmp_path / "b.yaml"), columns="")
    assert len(read(tmp_path / "a.csv", corpus=named)) == 60


CALIBRATION = (SAMPLES / "wearer.yaml").read_text()
BAD_CALIBRATION = {
    "no YAML": ("sensors:", "sensors: [", "is no YAML"),
    "no sensors": ("sensors:", "sensor:", "the key 'sensors' is missing"),
    "missing": ("  s08: {} ", "  # ", "the key 'sensors.s08' is missing"),
    "gain": ("s01: {gain: 0.5, ", "s01: {", "sensors.s01.gain is None, expected a number"),
    "offset": ("offset: 120", "offset: .nan", "sensors.s05.offset is nan, expected a number"),
    "joint": ("joint: index1, ", "joint: index4, ", "sensors.s06.joint is 'index4', expected one of wrist"),
    "axis": ("joint: wrist, axis: z", "joint: wrist, axis: w", "sensors.s22.axis is 'w', expected z, x or y"),
    "unknown key": ("s01: {gain", "s01: {gian: 1, gain", "there is no key sensors.s01.gian"),
    "weights": ("[0.7, -0.3]", "[0.7]", "sensors.s20.weights is [0.7]"),
    "also": ("factor: 0.6}]", "factor: much}]", "sensors.s07.also[0].factor is 'much'"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_CALIBRATION)
def test_what_is_refused_in_a_calibration_names_the_key(tmp_path, name):
    old, new, message = BAD_CALIBRATION[name]
    assert old in CALIBRATION
    (tmp_path / "a.csv").write_text(LOG)
    (tmp_path / "w.yaml").write_text(CALIBRATION.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        read(tmp_path / "a.csv")
    assert message in str(error.value) and "w.yaml" in str(error.value)


GOOD_MAP = {"fps": 24, "columns": [{"column": 0, "joint": "index1", "axis": "x"}]}
BAD_MAPS = [
    ({"fsp": 1}, "there is no key fsp"),
    ({"fps": 0}, "fps is 0, expected a number above 0"),
    ({"columns": []}, "the key 'columns' is missing"),
    ({"columns": [3]}, "columns[0] is 3"),
    ({"columns": [{"joint": "index1", "axis": "x"}]}, "columns[0] needs the number of one column"),
    ({"columns": [{"column": 0, "quaternion": 0}]}, "columns[0] needs the number of one column"),
    ({"columns": [{"quaternion": 0, "joint": "index1", "axis": "x"}]}, "columns[0].about is None"),
    ({"columns": [{"column": 0, "joint": "toe", "axis": "x"}]}, "columns[0].joint is 'toe'"),
    ({"columns": [{"column": 9, "joint": "index1", "axis": "x"}]}, "has no column of numbers 9, which"),
    ({"unit": "grad"}, "unit is 'grad'"),
    ({"separator": "::"}, "separator is '::', expected one character"),
    ({"header": -1}, "header is -1"),
    ({"count": 4}, "line 1: 2 values, expected 4"),
    ({"text": [1.5]}, "text is [1.5]"),
    ({"time": {"column": 0, "unit": "weeks"}}, "time.unit is 'weeks'"),
    ({"time": 3}, "time is 3"),
    ({"skip": 99}, "the table has no rows"),
]


@pytest.mark.parametrize("k", range(len(BAD_MAPS)))
def test_what_is_refused_in_a_column_map_names_the_key(tmp_path, k):
    changed, message = BAD_MAPS[k]
    (tmp_path / "a.txt").write_text("1 2\n3 4\n")
    with pytest.raises(InputError) as error:
        read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=GOOD_MAP | changed))
    assert message in str(error.value)


def test_what_is_refused_in_a_table_names_the_line(tmp_path):
    for content, message in (
        ("1 2\n3\n", "line 2: 1 value, expected 2"),
        ("1 2\n3 x\n", "line 2: 'x' is not a finite number"),
        ("", "line 1: the file ends before its first row"),
    ):
        (tmp_path / "a.txt").write_text(content)
        with pytest.raises(InputError) as error:
            read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=GOOD_MAP))
        assert message in str(error.value)
    with_text = GOOD_MAP | {"text": [1]}
    (tmp_path / "a.txt").write_text("1 a\nnan b\n")
    with pytest.raises(InputError, match="line 2: column 0 is no finite number"):
        read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=with_text))
    (tmp_path / "a.txt").write_text("1 a\n2 b c\n")
    with pytest.raises(InputError, match="line 2: 3 values, expected 2"):
        read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=with_text))
    (tmp_path / "a.txt").write_text("1 0\n2 1e9\n")
    clock = GOOD_MAP | {"time": {"column": 1}}
    with pytest.raises(InputError, match="line 2: the clock jumps by 1e"):
        read(tmp_path / "a.txt", corpus=SimpleNamespace(columns=clock))
