"""Label files and annotations: every notation of the same intervals, and what is refused."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi.errors import InputError
from miburi.formats import read_annotations, read_labels, write_annotations, write_labels
from miburi.formats.annotations import Annotation

SAMPLES = Path(__file__).parents[2] / "data" / "samples"
FIST = [(0, 10, "p"), (10, 21, "pr"), (21, 40, "r"), (40, 51, "rp"), (51, 60, "p")]


@pytest.mark.parametrize("name", ["fist.lab", "fist.tsv", "fist_audacity.txt"])
def test_the_samples_say_the_same(name):
    assert read_labels(SAMPLES / "glove" / name, fps=30, frames=60) == FIST


@pytest.mark.parametrize(
    ("name", "module", "package"),
    [("fist.TextGrid", "praatio.textgrid", "praatio"), ("fist.eaf", "pympi.Elan", "pympi-ling")],
)
def test_other_programs_files(name, module, package, monkeypatch, tmp_path):
    path = SAMPLES / "glove" / name
    with monkeypatch.context() as without:
        without.setitem(__import__("sys").modules, module, None)
        with pytest.raises(
            InputError, match=rf"needs the library {package}; install it with: pip install 'miburi"
        ):
            read_labels(path, fps=30)
    pytest.importorskip(module)
    assert read_labels(path, fps=30, frames=60) == [(0, 21, "p"), (21, 40, "r")]
    assert read_labels(path, fps=30, tier="gesture") == [(0, 21, "p"), (21, 40, "r")]
    with pytest.raises(InputError, match="there is no 'x'; its tiers of intervals are gesture"):
        read_labels(path, fps=30, tier="x")
    (tmp_path / name).write_text("nonsense")
    with pytest.raises(InputError, match=name):
        read_labels(tmp_path / name, fps=30)


@pytest.mark.parametrize(
    ("name", "content", "unit", "expected"),
    [
        ("a.lab", "0 10 p\n10 21 pr\n", None, [(0, 10, "p"), (10, 21, "pr")]),  # frames, by their size
        ("a.lab", "0 3333333 p\n", None, [(0, 10, "p")]),  # 100 ns, by their size
        (
            "a.lab",
            "0 0.35 p\n",
            None,
            [(0, 11, "p")],
        ),  # seconds, by the point; half a frame is rounded upwards
        ("a.lab", "0 3333333 p\n", "frames", [(0, 3333333, "p")]),
        ("a.lab", "0 30 p\n", "seconds", [(0, 900, "p")]),
        ("a.lab", "10 21 b\r\n0 10 a\r\n", None, [(0, 10, "a"), (10, 21, "b")]),
        ("a.lab", "0 10 two words\n", None, [(0, 10, "two words")]),
        ("a.tsv", "start_frame\tend_frame\tlabel\n0\t9\ta\n10\t19\tb\n", None, [(0, 10, "a"), (10, 20, "b")]),
        (
            "a.tsv",
            "start_frame\tend_frame\tlabel\n0\t10\ta\n10\t20\tb\n",
            None,
            [(0, 10, "a"), (10, 20, "b")],
        ),
        (
            "a.tsv",
            "start_frame\tend_frame\tlabel\n0\t10\ta\n15\t20\tb\n",
            None,
            [(0, 10, "a"), (15, 20, "b")],
        ),
        ("a.tsv", "start_frame\tend_frame_inclusive\tlabel\n0\t10\ta\n", None, [(0, 11, "a")]),
        ("a.tsv", "label\tx\tstart_frame\tend_frame_exclusive\na\t\t0\t10\n", None, [(0, 10, "a")]),
        ("a.txt", "0.0\t1.0\ta\n\\\t100\t200\n2\t3\tb\n", None, [(0, 30, "a"), (60, 90, "b")]),
        ("a.lab", "", None, []),
    ],
)
def test_notations(tmp_path, name, content, unit, expected):
    (tmp_path / name).write_text(content, newline="")
    assert read_labels(tmp_path / name, fps=30, unit=unit) == expected


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.lab", "0 10\n", "line 1: found '0 10', expected start, end and label"),
        ("a.lab", "0 ten p\n", "line 1: found 'ten', expected a time"),
        ("a.lab", "0 nan p\n", "line 1: the times 0 and nan cannot be"),
        ("a.lab", "-1 5 p\n", "line 1: the times -1 and 5 cannot be"),
        ("a.lab", "0 10 p\n9 20 r\n", "line 2: 'r' begins at frame 9, before 'p' ends at 10"),
        ("a.lab", "5 5 p\n", "line 1: the label 'p' from 5 to 5 has no frame"),
        ("a.lab", "9 5 p\n", "line 1: the label 'p' from 9 to 5 has no frame"),
        ("a.lab", "0 10 p\n\n90 101 r\n", "line 3: the label 'r' ends with frame 101, the take has 100"),
        ("a.lab", "0 1e300 p\n", "line 1: the times"),
        ("a.tsv", "start\tend\tlabel\n", "expected the columns start_frame, end_frame and label"),
        ("a.tsv", "", "expected the columns start_frame"),
        ("a.tsv", "start_frame\tend_frame\tlabel\n1\t2\n", "line 2: 2 columns, expected 3"),
        (
            "a.tsv",
            "start_frame\tend_frame\tlabel\n1\t2.5\ta\n",
            "line 2: found 1 and 2.5, expected whole frames",
        ),
        ("a.tsv", "start_frame\tend_frame\tlabel\n1\t5\t\n", "line 2: the label is empty"),
        ("a.txt", "1 2 a\n", "line 1: 1 columns, expected start, end and label of an Audacity"),
        ("a.doc", "", "cannot be read as labels; known are .lab"),
    ],
)
def test_what_is_refused_names_the_line(tmp_path, name, content, message):
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError) as error:
        read_labels(tmp_path / name, fps=30, frames=100)
    assert message in str(error.value) and name in str(error.value)


def test_an_unknown_unit():
    with pytest.raises(InputError, match="label_unit is 'ms', expected 100ns, frames or seconds"):
        read_labels(SAMPLES / "glove" / "fist.lab", fps=30, unit="ms")


@given(
    st.lists(
        st.tuples(st.integers(0, 3), st.integers(1, 500), st.sampled_from(["r", "p", "rp", "ä b"])),
        max_size=12,
    ),
    st.sampled_from([24.0, 29.97, 30.0, 60.0, 120.0]),
    st.sampled_from(["a.lab", "a.tsv", "a.txt"]),
)
def test_what_is_written_is_read_again(tmp_path_factory, steps, fps, name):
    intervals, at = [], 0
    for gap, length, label in steps:
        intervals.append((at + gap, at + gap + length, label))
        at += gap + length
    path = tmp_path_factory.mktemp("l") / name
    write_labels(path, intervals, fps=fps)
    unit = "100ns" if name == "a.lab" else None
    assert read_labels(path, fps=fps, unit=unit, frames=at) == intervals


def test_what_cannot_be_written_is_refused(tmp_path):
    for intervals, message in (
        ([(0, 5, "a"), (4, 6, "b")], "begins at frame 4"),
        ([(5, 5, "a")], "has no frame"),
        ([(0, 5, "a\tb")], "cannot be written"),
    ):
        with pytest.raises(InputError, match=message):
            write_labels(tmp_path / "a.lab", intervals, fps=30)
    with pytest.raises(InputError, match=r"written as \.lab"):
        write_labels(tmp_path / "a.eaf", [], fps=30)
    assert not list(tmp_path.iterdir())


def test_real_annotations(recordings):
    rows = read_annotations(recordings / "body" / "intervals.tsv")
    assert len(rows) > 200 and rows[0] == Annotation(
        "13_29", 0.0, 3.9, "JumpJack", {"source": "mocap6 true labels, 10 Hz"}
    )


def test_annotations_are_written_and_read_again(tmp_path):
    rows = read_annotations(SAMPLES / "annotations.tsv")
    assert [r.keyword for r in rows] == ["raise hand", "wave"] and rows[0].more == {"by": "hand"}
    rows.append(Annotation("other", 1 / 3, 2.0, "wave"))
    write_annotations(tmp_path / "a.tsv", rows)
    again = read_annotations(tmp_path / "a.tsv")
    assert again[:2] == rows[:2]
    assert again[2].start_s == pytest.approx(1 / 3, abs=1e-6) and again[2].more == {"by": ""}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("take\tstart_s\tend_s\n", "line 1: the column 'keyword' is missing; there are take, start_s, end_s"),
        ("", "the column 'take' is missing"),
        ("take\tstart_s\tend_s\tkeyword\ttake\n", "the column 'take' stands twice"),
        ("take\tstart_s\tend_s\tkeyword\na\t0\tx\tb\n", "line 2: end_s is 'x', expected seconds"),
        ("take\tstart_s\tend_s\tkeyword\na\tinf\t1\tb\n", "line 2: start_s is 'inf'"),
        ("take\tstart_s\tend_s\tkeyword\na\t-1\t1\tb\n", "line 2: start_s is '-1'"),
        ("take\tstart_s\tend_s\tkeyword\n\na\t2\t1\tb\n", "line 3: the end 1 s is not after the start 2 s"),
        ("take\tstart_s\tend_s\tkeyword\n\t0\t1\tb\n", "line 2: the take is empty"),
        ("take\tstart_s\tend_s\tkeyword\na\t0\t1\n", "line 2: the keyword is empty"),
        ("take\tstart_s\tend_s\tkeyword\na\t0\t1\tb\tc\n", "line 2: 5 columns, expected 4"),
    ],
)
def test_what_is_refused_in_annotations(tmp_path, content, message):
    (tmp_path / "a.tsv").write_text(content)
    with pytest.raises(InputError) as error:
        read_annotations(tmp_path / "a.tsv")
    assert message in str(error.value)
    with pytest.raises(InputError):
        write_annotations(tmp_path / "b.tsv", [Annotation("a", 2, 1, "x")])
