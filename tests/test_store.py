"""Artefacts: whole or not at all, checked when read, the same bytes for the same content."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from miburi import artefacts, store
from miburi.errors import InputError
from miburi.figures import HAND, PERSON
from miburi.kinematics import euler, hand_rotations
from miburi.motion import Motion


def filled(path, numbers=None):
    with store.create(path, "test", {"b.bvh": "1", "a.bvh": "2"}) as file:
        store.put(file, "x", np.arange(900.0).reshape(300, 3) if numbers is None else numbers)
        store.put(file, "names", ["歩く", "b", ""])
    return path


def test_what_was_put_is_got(tmp_path):
    path = filled(tmp_path / "deep" / "a.h5")
    with store.open_checked(path, "test") as file:
        np.testing.assert_array_equal(
            store.get(file, "x", (None, 3)), np.arange(900.0).reshape(300, 3), strict=True
        )
        assert store.get_strings(file, "names") == ["歩く", "b", ""]
        assert json.loads(file.attrs["sources"]) == {"a.bvh": "2", "b.bvh": "1"}
        with pytest.raises(InputError, match=r"a\.h5: /x has shape \(300, 3\), expected any × 4"):
            store.get(file, "x", (None, 4))
        with pytest.raises(InputError, match=r"/y is missing"):
            store.get(file, "y")
        with pytest.raises(InputError, match=r"/y is missing"):
            store.get_strings(file, "y")
    assert os.listdir(path.parent) == ["a.h5"]


@given(
    hnp.arrays(
        st.sampled_from([np.float32, np.float64, np.int64, np.int32, np.bool_]),
        hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=40),
        elements=st.just(1),
    ),
    st.booleans(),
)
def test_any_array_comes_back(tmp_path_factory, values, compress):
    path = tmp_path_factory.getbasetemp() / "any.h5"
    with store.create(path, "test") as file:
        store.put(file, "x", values, compress=compress)
    with store.open_checked(path, "test") as file:
        np.testing.assert_array_equal(store.get(file, "x"), values, strict=True)


def test_the_same_content_is_the_same_bytes(tmp_path):
    one = filled(tmp_path / "a.h5").read_bytes()
    time.sleep(1.1)  # HDF5's stamps have seconds
    assert filled(tmp_path / "b.h5").read_bytes() == one
    assert filled(tmp_path / "c.h5", np.zeros((300, 3))).read_bytes() != one
    assert store.digest(tmp_path / "a.h5") == hashlib.sha256(one).hexdigest()
    assert store.sources(tmp_path / "a.h5") == {str(tmp_path / "a.h5"): hashlib.sha256(one).hexdigest()}


def test_other_formats_and_versions_are_refused(tmp_path, monkeypatch):
    path = filled(tmp_path / "a.h5")
    with (
        pytest.raises(InputError, match=r"a\.h5: its format is 'miburi/test', expected 'miburi/motion'"),
        store.open_checked(path, "motion"),
    ):
        pass
    monkeypatch.setattr(store, "VERSION", 7)
    with (
        pytest.raises(InputError, match="its version is 1, this miburi reads version 7"),
        store.open_checked(path, "test"),
    ):
        pass
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = 1
    with (
        pytest.raises(InputError, match="its format is None"),
        store.open_checked(tmp_path / "foreign.h5", "test"),
    ):
        pass
    with (
        pytest.raises(InputError, match=r"b\.h5: there is no such file"),
        store.open_checked(tmp_path / "b.h5", "test"),
    ):
        pass


def _read(path):
    with store.open_checked(path, "test") as file:
        return store.get(file, "x", (300, 3)), store.get_strings(file, "names")


@pytest.mark.parametrize("keep", [0, 1, 100, 0.5, 0.99])
def test_a_file_that_was_cut_off(tmp_path, keep):
    path = filled(tmp_path / "a.h5", np.random.default_rng(0).standard_normal((300, 3)))
    whole = path.read_bytes()
    path.write_bytes(whole[: keep if isinstance(keep, int) else int(keep * len(whole))])
    with pytest.raises(InputError, match=r"a\.h5: not a readable HDF5 file .*run snakemake again"):
        _read(path)


def test_a_damaged_byte_in_the_numbers_is_noticed(tmp_path):
    numbers = np.random.default_rng(0).standard_normal((300, 3))
    path = filled(tmp_path / "a.h5", numbers)
    with h5py.File(path) as file:
        chunk = file["x"].id.get_chunk_info(0)
    damaged = bytearray(path.read_bytes())
    damaged[chunk.byte_offset + chunk.size // 2] ^= 0x10
    path.write_bytes(bytes(damaged))
    with pytest.raises(InputError, match=r"a\.h5: not a readable HDF5 file"):
        _read(path)


def test_a_writer_that_fails_leaves_the_old_file(tmp_path):
    path = filled(tmp_path / "a.h5")
    old = path.read_bytes()
    with pytest.raises(RuntimeError, match="half way"), store.create(path, "test") as file:
        store.put(file, "x", np.zeros(5))
        raise RuntimeError("half way")
    assert path.read_bytes() == old and os.listdir(tmp_path) == ["a.h5"]


def test_a_writer_that_is_killed_leaves_the_old_file(tmp_path):
    path = filled(tmp_path / "a.h5")
    old = path.read_bytes()
    code = f"""
import numpy as np
from miburi import store
with store.create({str(path)!r}, "test") as file:
    store.put(file, "x", np.zeros((300, 3)))
    file.flush()
    print("written", flush=True)
    input()
"""
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "written\n"
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert path.read_bytes() == old
    filled(path, np.zeros((300, 3)))  # and what it left behind is in nobody's way
    np.testing.assert_array_equal(_read(path)[0], 0)


def test_text_is_written_whole(tmp_path):
    path = tmp_path / "t.csv"
    store.write_text(path, "a\r\né\n")
    assert path.read_bytes() == b"a\r\n\xc3\xa9\n"
    with pytest.raises(UnicodeEncodeError):
        store.write_text(path, "\ud800")
    assert path.read_bytes() == b"a\r\n\xc3\xa9\n" and os.listdir(tmp_path) == ["t.csv"]


def test_seeds_depend_on_their_names():
    draw = {parts: store.seed(*parts).integers(1 << 40) for parts in [(1, "a"), (1, "b"), (2, "a"), ("1a",)]}
    assert len(set(draw.values())) == 4
    assert store.seed(1, "a").integers(1 << 40) == draw[1, "a"]
    assert store.seed("1", "a").integers(1 << 40) == draw[1, "a"]  # a config's 1 and "1" are one seed


def takes() -> dict[str, Motion]:
    rng = np.random.default_rng(3)
    angles = rng.uniform(-40, 90, (8, 48))
    person = euler(rng.uniform(-30, 30, (70, 14, 3)), "ZXY")
    moves = np.zeros((70, 14, 3))
    moves[:, 3] = 0.01
    return {
        "w/alk".replace("/", "_"): Motion(PERSON, 60, rng.standard_normal((70, 3)), person, name="w_alk"),
        "slides": Motion(PERSON, 60, np.zeros((70, 3)), person, translations=moves, name="slides"),
        "fist": Motion(HAND, 30, np.zeros((8, 3)), hand_rotations(angles), angles=angles, name="fist"),
    }


def test_motions_come_back(tmp_path):
    path, motions = tmp_path / "m.h5", takes()
    artefacts.write_motions(path, motions, {"fist": "fist.csv"}, {})
    found = artefacts.read_motions(path)
    assert list(found) == sorted(motions)
    for name, motion in found.items():
        wanted = motions[name]
        assert motion.skeleton.joints == wanted.skeleton.joints and motion.fps == wanted.fps
        np.testing.assert_allclose(motion.positions(), wanted.positions(), atol=1e-5)
        np.testing.assert_allclose(motion.end_positions(), wanted.end_positions(), atol=1e-5)
        assert (motion.angles is None) == (wanted.angles is None)
    assert found["slides"].translations is not None and found["w_alk"].translations is None
    with h5py.File(path) as file:
        assert len(file["skeletons"]) == 2  # two takes share one
        assert file["takes/fist"].attrs["recording"] == "fist.csv"
        assert file["takes/w_alk/root"].dtype == np.float32
    assert list(artefacts.read_motions(path, ["fist"])) == ["fist"]
    with pytest.raises(InputError, match=r"m\.h5.*'run'"):
        artefacts.read_motions(path, ["run"])
    artefacts.write_motions(tmp_path / "n.h5", dict(reversed(motions.items())), {"fist": "fist.csv"}, {})
    assert (tmp_path / "n.h5").read_bytes() == path.read_bytes()  # whatever the order


def test_what_a_killed_writer_left_is_removed(tmp_path):
    target = tmp_path / "a.b (c).h5"
    script = (
        "import os, signal; from miburi import store\n"
        f"with store.create({str(target)!r}, 'x') as file:\n"
        "    file['x'] = 1; file.flush(); os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    store.write_text(target.with_suffix(".csv"), "1")
    assert left.exists(), "it is of another file"
    filled(target)
    assert sorted(tmp_path.iterdir()) == [target.with_suffix(".csv"), target]


def test_what_others_are_writing_is_left_alone(tmp_path):
    target = tmp_path / "a.h5"
    with store.create(target, "x"):
        (mine,) = tmp_path.iterdir()
        script = f"from miburi import store; store.write_text({str(target)!r}, 'by another process')"
        subprocess.run([sys.executable, "-c", script], check=True)
        assert mine.exists()
    elsewhere = tmp_path / ".a.tmp-elsewhere-1.h5"
    for age, stays in ((0, True), (90_000, False)):
        elsewhere.write_text("")
        os.utime(elsewhere, (time.time() - age,) * 2)
        filled(target)
        assert elsewhere.exists() == stays
