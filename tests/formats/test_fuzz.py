"""Damaged files give a Motion or an InputError, nothing else, in memory that is in proportion to the file."""

import os
import shutil
import tracemalloc
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import miburi.formats as formats
from miburi.errors import InputError
from miburi.formats import asf_amc, glove
from miburi.motion import Motion

SAMPLES = Path(__file__).parents[2] / "data" / "samples"
EXAMPLES = int(os.environ.get("MIBURI_FUZZ", "60"))

NASTY = [
    b"nan", b"inf", b"-", b"1e999", b"-1e-999", b"999999999999999999999999", b"1000000000000", b"0",
    b"-1", b"1e5", b"", b" ", b"\n", b"\r", b"\t", b"{", b"}", b"[", b":", b"'", b"\x00", b"\xff",
    b"\xfc", b"\x1f\x8b", b"\xef\xbb\xbf", b"&a [*a]", b"!!python/object:x", b"JOINT a", b"End Site",
    b"CHANNELS 6", b"MOTION", b"Frames: 1000000000000", b"Frame Time: 0", b"0.0000000001", b"begin",
    b"end", b"root", b":bonedata", b"dof rx", b",", b",,", b"fps=0", b"#",
]  # fmt: skip


@st.composite
def damaged(draw, content: bytes) -> bytes:
    """A file with a few pieces cut out, doubled, moved or replaced."""
    data = content
    for _ in range(draw(st.integers(1, 4))):
        n = len(data)
        a = draw(st.integers(0, n))
        b = min(n, a + draw(st.sampled_from([0, 1, 1, 2, 5, 20, 200, n])))
        how = draw(st.sampled_from(["cut", "put", "put", "double", "truncate", "byte"]))
        if how == "cut":
            data = data[:a] + data[b:]
        elif how == "put":
            data = data[:a] + draw(st.sampled_from(NASTY)) + data[b if b - a < 6 else a :]
        elif how == "double":
            data = data[:b] + data[a:b] + data[b:]
        elif how == "truncate":
            data = data[:a]
        else:
            data = data[:a] + bytes([draw(st.integers(0, 255))]) + data[a + 1 :]
    return data[:200_000]


def bounded(call) -> None:
    """Run a reader; anything but a result or an InputError, or more than 60 MB for at most 0.2 MB, fails."""
    tracemalloc.start()
    try:
        result = call()
        assert not isinstance(result, Motion) or np.isfinite(result.rotations).all()
    except InputError as error:
        assert "\n" not in str(error)
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 60e6


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The samples side by side, each to be replaced in turn."""
    here = tmp_path_factory.mktemp("fuzz")
    for name in ("figure.asf", "wave.bvh", "figure_01.amc", "glove/wearer.yaml", "glove/fist.csv"):
        shutil.copy(SAMPLES / name, here)
    formats.read(here / "wave.bvh")  # kernels compiled, so that their memory is not counted
    return here


FILES = {
    "wave.bvh": lambda p: formats.read(p),
    "figure_01.amc": lambda p: formats.read(p),
    "figure.asf": lambda p: asf_amc.read_asf(p),
    "glove/fist.csv": lambda p: formats.read(
        p, corpus=SimpleNamespace(calibration=SAMPLES / "glove" / "wearer.yaml")
    ),
    "glove/wearer.yaml": lambda p: glove.read_calibration(p),
    "glove/other_logger.txt": lambda p: formats.read(p, corpus=SimpleNamespace(columns=TABLE)),
    "puppet/point.csv": lambda p: formats.read(p),
    "puppet/raw_counts.csv": lambda p: formats.read(
        p, corpus=SimpleNamespace(calibration=SAMPLES / "puppet" / "puppet.yaml")
    ),
    "glove/fist.lab": lambda p: formats.read_labels(p, fps=30, frames=60),
    "glove/fist.tsv": lambda p: formats.read_labels(p, fps=30),
    "glove/fist_audacity.txt": lambda p: formats.read_labels(p, fps=30),
    "annotations.tsv": lambda p: formats.read_annotations(p),
}  # fmt: skip
TABLE = {
    "fps": 24, "separator": ":", "decimal": ",", "unit": "radians", "time": {"column": 2},
    "columns": [{"column": 0, "joint": "index1", "axis": "x"}],
}  # fmt: skip


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", FILES)
def test_damaged_files(folder, name):
    content = (SAMPLES / name).read_bytes()

    @settings(max_examples=EXAMPLES)
    @given(damaged(content))
    def check(data):
        path = folder / Path(name).name
        path.write_bytes(data)
        bounded(lambda: FILES[name](path))

    check()


@pytest.mark.filterwarnings("error")
@settings(max_examples=EXAMPLES)
@given(data=st.data())
def test_damaged_gzip(folder, data):
    import gzip

    packed = gzip.compress((SAMPLES / "wave.bvh").read_bytes(), mtime=0)
    path = folder / "packed.bvh.gz"
    path.write_bytes(data.draw(damaged(packed)))
    bounded(lambda: formats.read(path))


@pytest.mark.filterwarnings("error")
@settings(max_examples=EXAMPLES)
@given(
    content=st.binary(max_size=300), ending=st.sampled_from(["bvh", "amc", "csv", "txt", "asf", "lab", "tsv"])
)
def test_any_bytes(folder, content, ending):
    path = folder / f"x.{ending}"
    path.write_bytes(content)
    bounded(lambda: formats.read_labels(path, fps=30) if ending in ("lab", "tsv") else formats.read(path))
