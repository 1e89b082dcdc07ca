"""The pages in a real browser, from disk: nothing is asked of a network, everything plays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.report.conftest import ROOT
from tests.report.test_page import HOSTILE, search_page

import miburi

pytestmark = pytest.mark.xdist_group("workflow")
WIDTHS = (360, 800, 1400)
SIZE = 6_000_000  # bytes of a report
BEYOND = """() => document.documentElement.scrollWidth <= innerWidth ? [] : [...document.querySelectorAll("main *")]
  .filter(e => e.getBoundingClientRect().right > innerWidth + 1 && !e.closest(".scroll, pre, svg"))
  .slice(0, 5).map(e => e.outerHTML.slice(0, 120))"""
AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"


@contextmanager
def opened(
    browser: Any, path: Path, width: int = 1400, theme: str = "light", **options: Any
) -> Iterator[Any]:
    """A page; the test fails where the console shows an error or anything is asked of a network."""
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=theme, **options)
    wrong: list[str] = []
    page.on("console", lambda m: wrong.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda e: wrong.append(str(e)))
    page.on(
        "request",
        lambda r: wrong.append(r.url) if not r.url.startswith(("file:", "data:", "blob:")) else None,
    )
    page.goto(path.as_uri())
    yield page
    page.close()
    assert not wrong


def part(page: Any, name: str) -> Any:
    """A part of the page, in view and built."""
    where = page.locator(f"[data-part={name}]")
    where.scroll_into_view_if_needed()
    page.wait_for_selector(f"[data-part={name}][data-ready]", timeout=20_000)
    page.wait_for_timeout(300)
    return where


def picture(canvas: Any) -> str:
    return str(canvas.evaluate("c => c.toDataURL()"))


def becomes(canvas: Any, other: str, same: bool = False) -> str:
    """The picture once it differs from another, or is the same again; what a browser draws, it draws soon."""
    for _ in range(100):
        now = picture(canvas)
        if (now == other) == same:
            return now
        canvas.page.wait_for_timeout(100)
    pytest.fail("the picture does not change" if not same else "the picture does not come back")


def settle(page: Any, stage: Any) -> None:
    """Stop the figures once they are drawn."""
    stage.locator("canvas").last.scroll_into_view_if_needed()
    for canvas in stage.locator("canvas").all():
        canvas.and_(canvas.page.locator("[data-drawn]")).wait_for(timeout=20_000)
    if stage.locator(".play").inner_text() == "Pause":
        stage.locator(".play").click()
    page.wait_for_timeout(200)


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("name", ["report", "search"])
def test_every_part_opens_at_every_width(
    browser: Any, pages: dict[str, Path], name: str, theme: str, tmp_path: Path
) -> None:
    with opened(browser, pages[name], WIDTHS[0], theme) as page:
        for there in page.locator("[data-part]").all():
            part(page, there.get_attribute("data-part"))
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_timeout(200)
            beyond = page.evaluate(BEYOND)
            assert not beyond, f"reaches beyond a window of {width} pixels"
            page.screenshot(path=tmp_path / f"{name}-{theme}-{width}.png", full_page=True)
        background = page.evaluate("getComputedStyle(document.body).backgroundColor")
        light = sum(int(v) for v in background.strip("rgb()").split(",")[:3]) > 3 * 128
        assert light == (theme == "light")


def test_the_report_is_small_and_all_its_clips_can_be_decoded(browser: Any, pages: dict[str, Path]) -> None:
    assert pages["report"].stat().st_size < SIZE
    with opened(browser, pages["report"]) as page:
        names = page.eval_on_selector_all("script[data-clip]", "all => all.map(s => s.dataset.clip)")
        facts = page.evaluate("JSON.parse(document.getElementById('clips').textContent).clips")
        assert sorted(names) == sorted(facts)
        assert len(names) > 10


def test_figures_play_seek_and_turn(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        where = part(page, "retrieval")
        stage = where.locator(".stage")
        assert stage.locator("canvas").count() >= 6
        settle(page, stage)
        canvas, slider, play = (
            stage.locator("canvas").first,
            stage.locator("input[type=range]"),
            stage.locator(".play"),
        )
        before = picture(canvas)
        slider.fill("0.2")
        first = becomes(canvas, before)
        slider.fill("1.4")
        becomes(canvas, first)
        slider.fill("0.2")
        becomes(canvas, first, same=True)
        play.click()
        becomes(canvas, first)
        play.click()
        assert float(slider.input_value()) > 0.2
        page.wait_for_timeout(300)
        before = picture(canvas)
        play.focus()
        page.keyboard.press("d")
        before = becomes(canvas, before)
        box = canvas.bounding_box()
        page.mouse.move(box["x"] + 40, box["y"] + 40)
        page.mouse.down()
        page.mouse.move(box["x"] + 90, box["y"] + 50)
        page.mouse.up()
        becomes(canvas, before)
        result = stage.locator(".hit canvas, .miss canvas").first
        before = picture(result)
        stage.get_by_label("Colour").select_option("shares")
        becomes(result, before)


def test_ten_figures_hold_thirty_frames_a_second(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"], 1400, device_scale_factor=1) as page:
        stage = part(page, "retrieval").locator(".stage")
        assert stage.locator("canvas").count() >= 10
        settle(page, stage)
        # drawing is timed, not what the browser makes of it: that depends on what else the machine does
        assert min(page.evaluate("window.miburi.cost(15)") for _ in range(3)) < 1000 / 30


def test_another_query_shows_other_results(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        where = part(page, "retrieval")
        before = where.locator("figcaption").all_inner_texts()
        where.get_by_role("button", name="another query").click()
        page.wait_for_timeout(200)
        assert where.locator("figcaption").all_inner_texts() != before
        where.get_by_label("protocol").select_option("2")
        assert "shown" not in where.locator(".about").inner_text()


def test_curves_are_read_by_hovering_and_move_the_hands(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        where = part(page, "gestures")
        settle(page, where.locator(".stage"))
        over = where.locator(".u-over").first
        box = over.bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 50)
        page.wait_for_timeout(200)
        values = where.locator(".u-legend").first.locator(".u-value").all_inner_texts()
        assert all(v != "–" for v in values), values
        slider = where.locator("input[type=range]")
        page.mouse.down()
        page.mouse.up()
        page.wait_for_timeout(200)
        half = (float(slider.get_attribute("max")) + float(slider.get_attribute("min"))) / 2
        assert float(slider.input_value()) == pytest.approx(half, rel=0.1)
        hand = picture(where.locator("canvas").last)
        where.get_by_role("button", name="sp", exact=True).click()
        becomes(where.locator("canvas").last, hand)
        assert float(slider.get_attribute("min")) > 0
        curve = picture(where.locator(".u-wrap canvas").first)
        where.get_by_label("joint").select_option(label="index1 flexion")
        becomes(where.locator(".u-wrap canvas").first, curve)


def test_a_piece_of_a_take_plays_at_a_click(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        where = part(page, "segmentation")
        pieces = where.locator(".track button")
        assert pieces.count() >= 2
        before = where.locator("figcaption").inner_text()
        pieces.nth(1).click()
        assert where.locator("figcaption").inner_text() != before
        assert pieces.nth(1).get_attribute("aria-pressed") == "true"
        chosen = where.locator(".controls select").nth(1)
        assert chosen.input_value() == "1"
        chosen.select_option("0")
        assert where.locator("figcaption").inner_text() == before


def test_pieces_stand_under_their_curve(browser: Any, pages: dict[str, Path]) -> None:
    for width in WIDTHS:
        with opened(browser, pages["report"], width) as page:
            where = part(page, "segmentation")
            curve = where.locator(".u-over").bounding_box()
            track = where.locator(".track").first.bounding_box()
            assert track["x"] == pytest.approx(curve["x"], abs=1)
            assert track["width"] == pytest.approx(curve["width"], abs=1)


def test_words_in_plots_can_be_read_at_every_width(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            high = page.eval_on_selector_all(
                ".plot text, .plot span",
                "all => all.map(e => parseFloat(getComputedStyle(e).fontSize) * (e.getScreenCTM?.().a ?? 1))",
            )
            assert len(high) > 10
            assert min(high) >= 11


def test_pictures_do_not_glare_in_the_dark_and_print_as_they_are(
    browser: Any, pages: dict[str, Path]
) -> None:
    look = "getComputedStyle(document.querySelector('video')).filter"
    with opened(browser, pages["report"], theme="dark") as page:
        assert page.evaluate(look).startswith("brightness")
        page.locator("[data-theme-switch]").click()
        assert page.evaluate(look) == "none"
        page.locator("[data-theme-switch]").click()
        assert page.evaluate(look).startswith("brightness")
        page.emulate_media(media="print")
        assert page.evaluate(look) == "none"


def test_tables_are_sorted_at_a_click(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        table = page.locator("#corpora table").first
        head = table.locator("th", has_text="seconds")
        for direction in ("ascending", "descending"):
            head.locator("button").click()
            assert head.get_attribute("aria-sort") == direction
            cells = [float(r.split("\t")[-1]) for r in table.locator("tbody tr").all_inner_texts()]
            assert cells == sorted(cells, reverse=direction == "descending")


def test_the_theme_is_switched_and_figures_follow(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"]) as page:
        stage = part(page, "gestures").locator(".stage")
        settle(page, stage)
        before = picture(stage.locator("canvas").first)
        page.locator("[data-theme-switch]").click()
        stage.scroll_into_view_if_needed()
        becomes(stage.locator("canvas").first, before)
        assert page.evaluate("getComputedStyle(document.body).backgroundColor") != "rgb(253, 253, 252)"


def test_a_found_clip_is_kept_as_bvh(browser: Any, pages: dict[str, Path], tmp_path: Path) -> None:
    with opened(browser, pages["search"]) as page:
        where = part(page, "search")
        links = where.get_by_role("link", name="BVH")
        assert links.count() == 10
        with page.expect_download() as download:
            links.first.click()
        kept = tmp_path / download.value.suggested_filename
        download.value.save_as(kept)
        motion = miburi.read(kept)
        assert len(motion) > 10
        assert kept.suffix == ".bvh"


def test_hostile_names_are_shown_as_text(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "hostile.html"
    path.write_text(search_page(HOSTILE))
    with opened(browser, path) as page:
        page.on("dialog", lambda d: pytest.fail("a script in a name was run"))
        part(page, "search")
        assert page.locator("img").count() == 0
        assert HOSTILE in page.locator("figcaption").first.inner_text()


def test_who_wants_no_movement_gets_none(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["report"], reduced_motion="reduce") as page:
        stage = part(page, "retrieval").locator(".stage")
        page.wait_for_timeout(300)
        assert stage.locator(".play").inner_text() == "Play"


def test_it_prints(browser: Any, pages: dict[str, Path]) -> None:
    with opened(browser, pages["search"]) as page:
        part(page, "search")
        assert len(page.pdf()) > 20_000


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("name", ["report", "search"])
def test_accessibility(browser: Any, pages: dict[str, Path], name: str, theme: str) -> None:
    if not AXE.exists():
        pytest.skip("axe-core is not installed (npm ci in web/)")
    with opened(browser, pages[name], 1400, theme, reduced_motion="reduce") as page:
        for there in page.locator("[data-part]").all():
            part(page, there.get_attribute("data-part"))
        page.add_script_tag(content=AXE.read_text(encoding="utf-8"))
        found = page.evaluate("async () => (await axe.run()).violations")
        assert not [f"{v['id']}: {n['html'][:140]}" for v in found for n in v["nodes"]]
