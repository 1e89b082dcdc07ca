"""One pair of verbs for all formats, and every real file there is: read, or refused with a reason."""

import gzip
import logging
import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import miburi.formats as formats
from miburi.errors import InputError
from miburi.figures import HAND, PERSON

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "data" / "samples"
MAPS = ROOT / "config" / "gloves"

COLUMN_MAPS = {
    "hand/cyberglove_rps/mock.txt.gz": "cyberglove_rps",
    "hand/graspdb14/*-su0?.txt.gz": "graspdb14",
    "hand/libras_cyberglove/alphabet+numbers.csv.gz": "cyberglove_sdk",
    "hand/libras_cyberglove/gesture_23.txt.gz": "cyberglove_sdk_blanks",
    "hand/cyberglove3_timing/*.csv.gz": "cyberglove3",
    "hand/rokoko_signs/*.csv.gz": "rokoko_smartglove",
}
NO_SKELETON = ("13_29", "13_30", "13_31", "15_01")


def settings_of(path: Path, recordings: Path) -> tuple[dict[str, object], bool]:
    """How a real file is read, and whether it is a recording at all."""
    relative = path.relative_to(recordings)
    if path.name.endswith(".amc.gz"):
        if relative.parts[0] == "body_hdm05":
            return {"skeleton": recordings / "body_hdm05" / "asf" / f"{path.name[:2]}.asf.gz"}, True
        return ({"skeleton": path.parent / "02.asf"} if path.name[:5] in NO_SKELETON else {}), True
    if ".bvh" in path.name:
        return {}, path.name != "odd_frames_line_wrong.bvh.gz"
    if relative.parts[0] == "puppet" and path.suffix == ".csv":
        return {}, True
    for pattern, name in COLUMN_MAPS.items():
        if relative.match(pattern):
            return {"corpus": SimpleNamespace(columns=MAPS / f"{name}.yaml")}, True
    return {}, False


@pytest.mark.filterwarnings("error")
def test_every_real_file_is_read_or_refused_with_a_reason(recordings):
    """With MIBURI_EVERY_FILE=1 all of them; otherwise one of the hundreds of alike clips in 25."""
    everything = bool(os.environ.get("MIBURI_EVERY_FILE"))
    counts = {"read": 0, "refused": 0}
    alike = 0
    for path in sorted(p for p in recordings.rglob("*") if p.is_file()):
        if path.relative_to(recordings).parts[0] in ("body_hdm05", "body_bandai") or "cmu" in str(
            path.parent
        ):
            alike += 1
            if not everything and alike % 25:
                continue
        settings, is_recording = settings_of(path, recordings)
        try:
            motion = formats.read(path, **settings)
        except InputError as error:
            assert not is_recording, error
            assert str(path) in str(error) and "\n" not in str(error)
            counts["refused"] += 1
            continue
        assert is_recording, path
        assert len(motion) > 0 and np.allclose(np.linalg.norm(motion.rotations, axis=-1), 1)
        assert np.abs(motion.root).max() < 100 and np.abs(motion.skeleton.offsets).max() < 10
        counts["read"] += 1
    print(counts)
    assert counts["read"] > 100 and counts["refused"] > 50


def test_takes_without_a_skeleton_say_what_was_looked_for(recordings):
    with pytest.raises(InputError, match=r"looked for 13\.asf and 13\.asf\.gz in .*, which has 6 others"):
        formats.read(recordings / "body" / "cmu" / "13_29.amc.gz")


@pytest.mark.parametrize(
    ("name", "frames", "joints"),
    [
        ("wave.bvh", 30, 14),
        ("figure_01.amc", 12, 7),
        ("glove/fist.csv", 60, 16),
        ("puppet/point.csv", 45, 14),
        ("puppet/raw_counts.csv", 31, 14),
    ],
)
def test_the_samples_plain_and_gzipped(tmp_path, name, frames, joints):
    plain = formats.read(SAMPLES / name)
    assert (len(plain), len(plain.skeleton)) == (frames, joints)
    assert plain.name == Path(name).stem
    for neighbour in (SAMPLES / name).parent.glob("*"):
        if neighbour.is_file():
            shutil.copy(neighbour, tmp_path)
    packed = tmp_path / f"{Path(name).name}.gz"
    packed.write_bytes(gzip.compress((SAMPLES / name).read_bytes()))
    again = formats.read(packed)
    assert again.name == plain.name
    np.testing.assert_array_equal(again.positions(), plain.positions())


def test_what_is_no_recording_is_refused_with_what_is_known(tmp_path):
    for name in ("a.c3d", "a.fbx", "a", "a.yaml", "a.asf", "a.txt", "a.csv"):
        (tmp_path / name).write_text("hello\n")
        with pytest.raises(InputError) as error:
            formats.read(tmp_path / name)
        assert str(error.value).startswith(str(tmp_path / name))
        if name != "a.asf":
            assert (
                ".bvh" in str(error.value) and ".amc" in str(error.value) and "puppet log" in str(error.value)
            )
    with pytest.raises(InputError, match=r"written as \.bvh or \.bvh\.gz"):
        formats.write(tmp_path / "a.fbx", formats.read(SAMPLES / "wave.bvh"))


def test_settings_of_a_corpus_are_used():
    wave = SAMPLES / "wave.bvh"
    plain = formats.read(wave)
    empty = SimpleNamespace(unit=None, up=None, fps=None, skeleton="", calibration="", columns="", joints={})
    np.testing.assert_array_equal(formats.read(wave, corpus=empty).positions(), plain.positions())
    halved = formats.read(wave, corpus=SimpleNamespace(unit=0.005, fps=60))
    assert halved.fps == 60 and formats.read(wave, fps=15, corpus=SimpleNamespace(fps=60)).fps == 15
    np.testing.assert_allclose(halved.positions() * 2, plain.positions(), atol=1e-9)
    lying = formats.read(wave, corpus=SimpleNamespace(up="z", unit=0.01))
    x, y, z = np.moveaxis(plain.positions(), -1, 0)
    np.testing.assert_allclose(lying.positions(), np.stack([x, z, -y], axis=-1), atol=1e-9)
    for wrong, message in (({"unit": -1}, "unit: found -1"), ({"up": "w"}, "up: found 'w'")):
        with pytest.raises(InputError, match=message):
            formats.read(wave, corpus=SimpleNamespace(**wrong))
    amc = SAMPLES / "figure_01.amc"
    assert formats.read(amc, corpus=SimpleNamespace(skeleton=SAMPLES / "figure.asf", fps=60)).fps == 60


def test_what_was_chosen_can_be_seen(recordings, caplog):
    path = recordings / "formats" / "fair_optical.bvh.gz"
    with caplog.at_level(logging.INFO, logger="miburi"):
        formats.read(path)
    assert "fair_optical: 1 unit = 0.0254 m (inches make a body" in caplog.text and "z is up" in caplog.text
    facts = formats.inspect(path)
    assert (facts["format"], facts["unit"], facts["up"], facts["joints"]) == ("BVH", 0.0254, "z", 27)
    facts = formats.inspect(SAMPLES / "figure_01.amc")
    assert facts["unit"] == pytest.approx(0.0254 / 0.45) and facts["up"] == "y"
    assert formats.inspect(SAMPLES / "glove" / "fist.csv")["format"] == "table"


def test_somebody_who_lies_down_does_not_change_what_is_up(tmp_path):
    """Standing and lying in one take: the floor decides; in a file with Z up as well."""
    from dataclasses import replace

    from miburi.formats import bvh, puppet, units

    angles = np.zeros((100, 17))
    angles[40:, 15] = 90.0  # falls forward and lies
    fall = puppet.motion(angles, 30)
    root = np.zeros((100, 3))
    root[:, 1] = np.where(np.arange(100) < 40, 0.9, 0.1)
    fall = replace(fall, root=root)
    assert units.choose(fall).up == "y"
    # the same in z-up coordinates
    x_up = units.turned(fall, "-z")
    assert units.choose(x_up).up == "z"
    np.testing.assert_allclose(units.turned(x_up, "z").positions(), fall.positions(), atol=1e-12)
    bvh.write(tmp_path / "a.bvh", fall)
    assert bvh.load(tmp_path / "a.bvh")[1].up == "y"


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_turning_is_a_rotation_that_brings_up_to_y(up):
    from miburi.formats import units

    motion = formats.read(SAMPLES / "wave.bvh")
    turned = units.turned(motion, up)
    axis = {"x": 0, "y": 1, "z": 2}[up[-1]]
    sign = -1 if up.startswith("-") else 1
    np.testing.assert_allclose(turned.positions()[..., 1], sign * motion.positions()[..., axis], atol=1e-12)
    d = lambda m: np.linalg.norm(np.diff(m.positions(), axis=1), axis=-1)  # noqa: E731
    np.testing.assert_allclose(d(turned), d(motion), atol=1e-12)


def test_library_s_face():
    assert HAND.joints[0] == "wrist" and PERSON.joints[0] == "waist"
    for name in formats.__all__:
        assert hasattr(formats, name)
