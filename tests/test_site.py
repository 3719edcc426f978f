"""The website of the documentation: whole, without a network, and with no link that leads nowhere."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import maulstick as ms
from maulstick.cli.lazy import SUMMARIES
from tests.support.chromium import chromium
from tests.support.pages import ROOT

FETCHED = {"script": ("src",), "img": ("src", "srcset"), "iframe": ("src",), "source": ("src", "srcset")}
STYLES = ("stylesheet", "preload", "preconnect", "dns-prefetch", "icon", "modulepreload")


class Read(HTMLParser):
    """What a page has: anchors, links for people, and what a browser fetches by itself."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        has = {name: value or "" for name, value in attrs}
        self.anchors |= {has[name] for name in ("id", "name") if name in has}
        if tag == "a" and "href" in has:
            self.links.append(has["href"])
        if tag == "link" and has.get("rel") in STYLES:
            self.fetched.append(has["href"])
        self.fetched += [has[name] for name in FETCHED.get(tag, ()) if name in has]
        self.fetched += re.findall(r"url\(([^)]+)\)", has.get("style", ""))


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The website, built anew."""
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    ran = subprocess.run(build, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Read]:
    """All pages but that of a server that finds none, whose links begin at the server's root."""
    return {path: Read(path) for path in sorted(site.rglob("*.html")) if path.name != "404.html"}


def leads_nowhere(page: Path, link: str, pages: dict[Path, Read]) -> bool:
    """Whether a link of a page to this website has no file, or no such anchor there."""
    parts = urlsplit(link)
    if parts.scheme or parts.netloc:
        return False
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if not target.is_file():
        return True
    return bool(parts.fragment) and target in pages and unquote(parts.fragment) not in pages[target].anchors


def test_every_link_inside_leads_somewhere(pages: dict[Path, Read]) -> None:
    assert [
        (page.name, link) for page, read in pages.items() for link in read.links if leads_nowhere(page, link, pages)
    ] == []


def test_a_browser_fetches_nothing_from_elsewhere(site: Path, pages: dict[Path, Read]) -> None:
    fetched = [(page, address) for page, read in pages.items() for address in read.fetched]
    styles = [*site.rglob("*.css")]
    for style in styles:
        text = re.sub(r"/\*.*?\*/", "", style.read_text(encoding="utf-8"), flags=re.DOTALL)
        fetched += [
            (style, address.strip("'\""))
            for address in re.findall(r"url\(([^)]+)\)|@import\s+([^;]+);", text)
            for address in address
            if address
        ]
    assert len(styles) >= 2
    assert len(fetched) > 10 * len(pages) / 2
    outside = [(page.name, address) for page, address in fetched if re.match(r"(?:https?:)?//", address)]
    assert outside == []
    assert [
        (page.name, address)
        for page, address in fetched
        if not address.startswith(("data:", "#")) and leads_nowhere(page, address, pages)
    ] == []


def test_every_page_of_docs_is_there_and_in_the_navigation(site: Path, pages: dict[Path, Read]) -> None:
    listed = {link for link in pages[site / "index.html"].links if not link.startswith("#")}
    for path in sorted((ROOT / "docs").glob("**/*.md")):
        assert path.relative_to(ROOT / "docs").with_suffix(".html").as_posix() in listed, path.name


def test_the_reference_has_every_command_and_every_name_of_the_front_door(site: Path, pages: dict[Path, Read]) -> None:
    commands, python = pages[site / "commands.html"], pages[site / "python.html"]
    assert {f"maulstick-{name}" for name in SUMMARIES} <= commands.anchors
    assert {f"maulstick.{name}" for name in ms.__all__ if name != "__version__"} <= python.anchors
    assert "Raises" in (site / "python.html").read_text(encoding="utf-8")


def test_the_page_of_rooms_draws_imports_and_all_point_down(site: Path) -> None:
    page = (site / "rooms.html").read_text(encoding="utf-8")
    names = re.findall(r'text-anchor="end">(\w+)</text>', page)
    drawn = re.findall(r"<title>(\w+) imports (\w+): \d+</title>", page)
    assert {path.name for path in (ROOT / "src" / "maulstick").iterdir() if (path / "__init__.py").is_file()} <= {
        *names
    }
    assert ("jobs", "planning") in drawn
    assert [pair for pair in drawn if names.index(pair[0]) >= names.index(pair[1])] == []


def test_search_finds_pages_from_the_disk_and_asks_no_server(site: Path) -> None:
    asked: list[str] = []
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.on("request", lambda request: asked.append(request.url))
        page.goto((site / "index.html").as_uri())
        page.locator(".md-search__input").first.click()
        page.keyboard.type("margin")
        page.locator(".md-search-result__link").first.wait_for()
        assert page.locator(".md-search-result__link").count() > 3
    assert [address for address in asked if not address.startswith(("file:", "data:", "blob:"))] == []
