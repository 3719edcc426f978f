from starlette.applications import Starlette
from starlette.responses import Response
from starlette.routing import Route
from starlette.testclient import TestClient

from maulstick.studio.server.packed import KeptGZip

CONTENT = b"a" * 2000
FILE, PAGE = "/_nicegui/1/static/a.js", "/plan"


def served() -> tuple[TestClient, list[str]]:
    """A browser of a site with a file and a page, and the paths that the site was asked for."""
    asked: list[str] = []

    def answer(request: object) -> Response:
        asked.append(request.url.path)  # type: ignore[attr-defined]
        return Response(CONTENT)

    site = Starlette(routes=[Route(FILE, answer), Route(PAGE, answer)])
    return TestClient(KeptGZip(site)), asked


def test_a_file_that_never_changes_is_compressed_once() -> None:
    browser, asked = served()
    for _ in range(3):
        answer = browser.get(FILE, headers={"Accept-Encoding": "gzip"})
        assert (answer.content, answer.headers["content-encoding"]) == (CONTENT, "gzip")
        assert int(answer.headers["content-length"]) < len(CONTENT)
    assert asked == [FILE]


def test_pages_and_browsers_that_read_no_gzip_are_answered_each_time() -> None:
    browser, asked = served()
    for path, reads in ((PAGE, "gzip"), (PAGE, "gzip"), (FILE, "identity"), (FILE, "gzip"), (FILE, "identity")):
        answer = browser.get(path, headers={"Accept-Encoding": reads})
        assert answer.content == CONTENT
        assert answer.headers.get("content-encoding") == (None if reads == "identity" else "gzip")
    assert asked == [PAGE, PAGE, FILE, FILE, FILE]


def test_what_is_not_there_is_not_kept() -> None:
    browser, _ = served()
    for _ in range(2):
        assert browser.get("/_nicegui/no.js", headers={"Accept-Encoding": "gzip"}).status_code == 404
