"""Films and contact sheets: whole, the same bytes, and what they show."""

from __future__ import annotations

import resource
import signal
import subprocess

import numpy as np
import pytest
from PIL import Image

from miburi.errors import InputError
from miburi.render import film, scene, sheets

from .test_scene import fist, person


def test_a_film_is_what_was_rendered(tmp_path):
    motion = fist(12)
    assert film.film(tmp_path / "a.mp4", motion, width=160, height=120) == 12
    fps, pictures = film.decode(tmp_path / "a.mp4")
    assert fps == 30 and pictures.shape == (12, 120, 160, 3)
    rendered = np.stack(list(scene.frames(motion, width=160, height=120)))
    assert np.abs(pictures.astype(np.int16) - rendered).mean() < 3
    # and not some other frame
    apart = [np.abs(pictures[0].astype(np.int16) - p).mean() for p in rendered]
    assert int(np.argmin(apart)) == 0 and apart[-1] > 2 * apart[0]
    film.film(tmp_path / "b.mp4", motion, width=160, height=120)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_other_rates_and_several_figures(tmp_path):
    count = film.film(tmp_path / "a.mp4", [fist(31), person(16)], fps=15, width=160, height=120)
    assert count == 16  # the longest: 30 steps at 30 a second are 15 at 15
    assert film.decode(tmp_path / "a.mp4")[0] == 15


def test_words_stand_above_and_below_and_captions_come_and_go(tmp_path):
    motion = fist(9)
    film.film(
        tmp_path / "a.mp4", motion, width=160, height=120, title="simulated", captions=[(0.1, 0.2, "pr")]
    )
    pictures = film.decode(tmp_path / "a.mp4")[1].astype(np.int16)
    dark = 255 - pictures.min(axis=-1)
    assert (dark[:, :17, :80].max(axis=(1, 2)) > 120).all()  # the title, throughout
    below = dark[:, 106:, :40].max(axis=(1, 2))
    assert (below[3:6] > 120).all() and (below[[0, 1, 2, 7, 8]] < 40).all()
    assert (dark[:, 20:100].max(axis=(1, 2)) > 120).all()  # the hand between


def test_names_stand_under_their_figures(tmp_path):
    film.film(tmp_path / "a.mp4", [person(2), fist(2), person(2)], names=["i", "", "i"])
    picture = film.decode(tmp_path / "a.mp4")[1][0].astype(np.int16)
    band = np.flatnonzero((255 - picture[448:].min(axis=-1)).max(axis=0) > 120)
    figures = np.flatnonzero((np.ptp(picture[:440], axis=-1) > 30).any(axis=0))
    for side in (0, -1):
        assert abs(band[side] - figures[side]) < 130
    assert band[0] < 320 < band[-1]


def test_a_disk_that_is_full_and_an_ffmpeg_that_fails(tmp_path, monkeypatch):
    path = tmp_path / "a.mp4"
    path.write_bytes(b"old")
    with monkeypatch.context() as patch:
        patch.setattr(film, "_BIT_EXACT", ("-preset", "none"))
        with pytest.raises(InputError, match=r"a\.mp4: the film cannot be written \(ffmpeg: .*preset"):
            film.film(path, fist(3), width=160, height=120)

    popen = subprocess.Popen

    def limited(*arguments, **settings):  # the kernel refuses ffmpeg more than 2 kB, as a full disk would
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))

        return popen(*arguments, preexec_fn=limit, **settings)

    monkeypatch.setattr(film.subprocess, "Popen", limited)
    with pytest.raises(InputError, match=r"a\.mp4: the film cannot be written \(ffmpeg: "):
        film.film(path, fist(60), width=640, height=480)
    assert path.read_bytes() == b"old" and [p.name for p in tmp_path.iterdir()] == ["a.mp4"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"width": 161}, "even numbers"),
        ({"fps": 0}, "0 pictures per second"),
        ({"fps": float("nan")}, "nan pictures per second"),
    ],
)
def test_films_that_cannot_be(tmp_path, settings, message):
    with pytest.raises(InputError, match=message):
        film.film(tmp_path / "a.mp4", fist(3), **settings)
    assert not list(tmp_path.iterdir())


def test_a_film_that_breaks_leaves_the_old_one(tmp_path, monkeypatch):
    path = tmp_path / "a.mp4"
    path.write_bytes(b"old")

    def breaks(*_, **__):
        yield np.zeros((120, 160, 3), np.uint8)
        raise RuntimeError("half way")

    monkeypatch.setattr(film.scene, "frames", breaks)
    with pytest.raises(RuntimeError, match="half way"):
        film.film(path, fist(3), width=160, height=120)
    assert path.read_bytes() == b"old" and [p.name for p in tmp_path.iterdir()] == ["a.mp4"]


def test_a_sheet_shows_its_frames(tmp_path):
    motion = fist(20)
    strips = [sheets.Strip("", [0, 19]), sheets.Strip("closing", [5, 10, 15])]
    for name in ("a.png", "b.png"):
        sheets.sheet(tmp_path / name, motion, strips, width=120, height=100, captions=["p"] * 20)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    page = np.asarray(Image.open(tmp_path / "a.png"))
    assert page.shape[1] == 3 * 120
    rendered = list(scene.frames(motion, width=120, height=100, at=[0, 19, 5]))
    np.testing.assert_array_equal(page[:100, :120], rendered[0])
    np.testing.assert_array_equal(page[:100, 120:240], rendered[1])
    assert (page[:100, 240:] == 255).all()
    assert (page[100:123, :240] < 120).any()  # time and label below


def test_sheets_that_cannot_be(tmp_path):
    with pytest.raises(InputError, match="without a frame"):
        sheets.sheet(tmp_path / "a.png", fist(3), [])
    with pytest.raises(InputError, match="frames 0 to 3, the motion has 3"):
        sheets.sheet(tmp_path / "a.png", fist(3), [sheets.Strip("", [0, 3])])
    with pytest.raises(InputError, match="2 captions for 3 frames"):
        sheets.sheet(tmp_path / "a.png", fist(3), [sheets.Strip("", [0])], captions=["a", "b"])
    assert not list(tmp_path.iterdir())


def test_rows_cover_a_motion():
    strips = sheets.rows(person(100), columns=3, count=7)
    shown = [k for s in strips for k in s.frames]
    assert [len(s.frames) for s in strips] == [3, 3, 1]
    assert shown == [0, 16, 33, 50, 66, 82, 99]  # 99 k / 6 to the nearest frame, a half to the even one
    assert [k for s in sheets.rows(person(2)) for k in s.frames] == [0, 1]


def test_strips_of_changes():
    labels, boundaries = ["r", "rs", "s", "sp", "p"], [0, 9, 21, 30, 42, 60]
    one, two = sheets.changes(labels, boundaries, ["rs", "sp"], columns=5)
    assert one.title == "(1) rs" and two.title == "(2) sp"
    assert one.frames[0] == 6 and one.frames[-1] == 23 and len(one.frames) == 5
    assert two.frames[0] == 27 and two.frames[-1] == 47
    with pytest.raises(InputError, match="strip of 'pr' is wanted, the string is r rs s sp p"):
        sheets.changes(labels, boundaries, ["pr"])


def test_each_figure_has_its_own_caption(tmp_path):
    captions = [[(0, 0.05, "mmm")], [(0.05, 1, "mmm")]]
    film.film(tmp_path / "a.mp4", [fist(4), fist(4)], width=320, height=120, own_captions=captions)
    dark = 255 - film.decode(tmp_path / "a.mp4")[1].astype(np.int16).min(axis=-1)
    left, right = dark[:, 106:, :160].max(axis=(1, 2)) > 120, dark[:, 106:, 160:].max(axis=(1, 2)) > 120
    assert left.tolist() == [True, True, False, False]
    assert right.tolist() == [False, False, True, True]
    with pytest.raises(InputError, match="captions of 1 figures for 2"):
        film.film(tmp_path / "b.mp4", [fist(4), fist(4)], own_captions=captions[:1])


def test_an_animated_webp_shows_the_same(tmp_path):
    motion = fist(7)
    assert film.film(tmp_path / "a.webp", motion, width=160, height=120) == 7
    rendered = list(scene.frames(motion, width=160, height=120))
    animation = Image.open(tmp_path / "a.webp")
    assert animation.n_frames == 7 and animation.info["loop"] == 0
    for k, picture in enumerate(rendered):
        animation.seek(k)
        assert np.abs(np.asarray(animation.convert("RGB")).astype(np.int16) - picture).mean() < 4
    film.film(tmp_path / "b.webp", motion, width=160, height=120)
    assert (tmp_path / "a.webp").read_bytes() == (tmp_path / "b.webp").read_bytes()
