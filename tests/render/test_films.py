"""Films and contact sheets: whole, the same bytes, and what they show."""

from __future__ import annotations

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


def test_captions_come_and_go(tmp_path):
    motion = fist(9)
    film.film(tmp_path / "a.mp4", motion, width=160, height=120)
    film.film(tmp_path / "b.mp4", motion, width=160, height=120, captions=[(0.1, 0.2, "pr")])
    plain, written = (film.decode(tmp_path / f)[1].astype(np.int16) for f in ("a.mp4", "b.mp4"))
    corner = np.abs(plain - written)[:, 100:, :40].max(axis=(1, 2, 3))
    assert (corner[3:6] > 90).all() and (corner[[0, 1, 2, 7, 8]] < 60).all()


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
