"""Fetching from a server on the loopback address that breaks connections and sends damaged files."""

from __future__ import annotations

import gzip
import http.server
import re
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from miburi import fetch
from miburi.errors import InputError


class Site(http.server.ThreadingHTTPServer):
    """Serves files; `broken` names those whose first answers stop half-way, `damaged` those that are cut."""

    def __init__(self, files: dict[str, bytes]) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.files = files
        self.broken: dict[str, int] = {}
        self.busy: dict[str, int] = {}
        self.asked: list[tuple[str, str | None]] = []

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


class Handler(http.server.BaseHTTPRequestHandler):
    server: Site

    def do_GET(self) -> None:
        name = self.path.rsplit("/", 1)[-1]
        wanted = self.headers.get("Range")
        self.server.asked.append((self.path, wanted))
        if self.server.busy.get(name, 0) > 0:
            self.server.busy[name] -= 1
            self.send_error(503)
            return
        if name not in self.server.files:
            self.send_error(404)
            return
        data = self.server.files[name]
        start = int(wanted.removeprefix("bytes=").rstrip("-")) if wanted else 0
        if start >= len(data) > 0:
            self.send_error(416)
            return
        part = data[start:]
        self.send_response(206 if wanted else 200)
        self.send_header("Content-Length", str(len(part)))
        self.end_headers()
        if self.server.broken.get(name, 0) > 0:
            self.server.broken[name] -= 1
            part = part[: len(part) // 2]
        self.wfile.write(part)

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def site(recordings: Path) -> Iterator[Site]:
    """The CMU recordings of two takes, as the database's site serves them."""
    folder = recordings / "body" / "cmu"
    files = {"02.asf": (folder / "02.asf").read_bytes()}
    for take in ("02_01", "02_02"):
        files[f"{take}.amc"] = gzip.decompress((folder / f"{take}.amc.gz").read_bytes())
    server = Site(files)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.shutdown()


@pytest.fixture(autouse=True)
def _no_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fetch, "BACKOFF_S", 0.01)


def wanted(folder: Path) -> list[Path]:
    return [folder / name for name in ("02_01.amc", "02_02.amc", "02.asf")]


def test_files_arrive_as_they_are(site: Site, tmp_path: Path) -> None:
    fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    for path in wanted(tmp_path):
        assert path.read_bytes() == site.files[path.name]
    assert site.asked[0][0] == "/subjects/02/02.asf"


def test_a_broken_download_is_resumed(site: Site, tmp_path: Path) -> None:
    site.broken["02_01.amc"] = 2
    fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    starts = [int(r[6:-1]) if r else 0 for path, r in site.asked if path.endswith("02_01.amc")]
    size = len(site.files["02_01.amc"])
    assert starts[0] == 0
    assert 0.45 * size < starts[1] <= 0.5 * size < 0.7 * size < starts[2] <= 0.75 * size
    assert (tmp_path / "02_01.amc").read_bytes() == site.files["02_01.amc"]


def test_a_busy_server_is_asked_again(site: Site, tmp_path: Path) -> None:
    site.busy["02.asf"] = 1
    fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    assert (tmp_path / "02.asf").exists()


def test_what_arrived_is_kept_for_the_next_run(site: Site, tmp_path: Path) -> None:
    missing = site.files.pop("02_02.amc")
    with pytest.raises(InputError, match=r"02_02\.amc: the site has no such file"):
        fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    assert not any(path.exists() for path in wanted(tmp_path)), "all or nothing"
    site.files["02_02.amc"] = missing
    site.asked.clear()
    fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    assert [path for path, _ in site.asked] == ["/subjects/02/02_02.amc"]


def test_a_damaged_file_is_refused(site: Site, tmp_path: Path) -> None:
    site.files["02_01.amc"] = site.files["02_01.amc"][:5000].rsplit(b"\n", 1)[0] + b"\nlfemur 1 2\n"
    with pytest.raises(InputError, match=r"02_01\.amc"):
        fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    assert not any(path.exists() for path in wanted(tmp_path))


def test_a_download_that_was_killed_goes_on(site: Site, tmp_path: Path) -> None:
    """What a killed run leaves is never taken for a whole file, even where it could be parsed."""
    part = tmp_path / "arriving" / "02_01.amc.part"
    part.parent.mkdir()
    data = site.files["02_01.amc"]
    part.write_bytes(data[: re.search(rb"(?m)^100\s*$", data).start()])
    fetch.subject(site.address, "02", wanted(tmp_path), progress=False)
    assert (tmp_path / "02_01.amc").read_bytes() == data


def test_a_site_that_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fetch, "RETRIES", 0)
    with pytest.raises(InputError, match=r"cannot be fetched"):
        fetch.subject("http://127.0.0.1:9", "02", [tmp_path / "02.asf"], progress=False)
