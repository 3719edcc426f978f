"""Link to the studio: its token is kept, hidden from other users of the machine, and leads in from a tablet."""

import os
import stat
from ipaddress import ip_address
from pathlib import Path

import pytest

from maulstick.errors import InputError, OutputError
from maulstick.studio.server.link import TOKEN_FILE, is_loopback, kept_token, link_to, page_that_leads_to
from tests.studio.conftest import RunningStudio
from tests.support.studio.intruder import Intruder


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_the_token_lasts_and_is_its_owners_alone_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        token = kept_token(tmp_path)
    finally:
        os.umask(before)
    assert mode_of(tmp_path / TOKEN_FILE) == 0o600
    (tmp_path / TOKEN_FILE).chmod(0o644)
    assert kept_token(tmp_path) == token
    assert mode_of(tmp_path / TOKEN_FILE) == 0o600


@pytest.mark.parametrize("content", [b"", b"short\n", b"\xff\xfe", b"a token with spaces that is long enough"])
def test_what_a_power_cut_left_of_a_token_opens_nothing(tmp_path: Path, content: bytes) -> None:
    (tmp_path / TOKEN_FILE).write_bytes(content)
    token = kept_token(tmp_path)
    assert token.encode() != content.strip()
    assert len(token) == 22
    assert kept_token(tmp_path) == token


def test_whoever_deletes_the_token_gets_another(tmp_path: Path) -> None:
    token = kept_token(tmp_path)
    (tmp_path / TOKEN_FILE).unlink()
    assert kept_token(tmp_path) != token


def test_a_token_that_cannot_be_kept_is_told(tmp_path: Path) -> None:
    (tmp_path / TOKEN_FILE).mkdir()
    with pytest.raises(OutputError, match="cannot keep the studio's token in "):
        kept_token(tmp_path)


def test_a_browser_is_led_in_by_a_page_that_nobody_else_can_read_and_that_goes_again(tmp_path: Path) -> None:
    link = link_to("127.0.0.1", 8337, "a" * 22)
    with page_that_leads_to(link, tmp_path) as address:
        (page,) = tmp_path.iterdir()
        assert address == page.as_uri()
        assert mode_of(page) == 0o600
        assert f"url={link}" in page.read_text()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_the_link_names_an_address_that_another_machine_can_reach(host: str) -> None:
    shown = link_to(host, 8337, "t").removeprefix("http://").removesuffix(":8337/?token=t")
    try:
        reached = ip_address(shown.strip("[]"))
    except ValueError:
        return  # this machine has no network, so its name is all that there is
    assert not reached.is_unspecified
    assert not reached.is_loopback


def test_an_address_that_was_named_is_kept() -> None:
    assert link_to("192.168.1.20", 80, "t") == "http://192.168.1.20:80/?token=t"
    assert link_to("fe80::1", 80, "t") == "http://[fe80::1]:80/?token=t"


@pytest.mark.parametrize(("host", "so"), [("localhost", True), ("127.8.8.8", True), ("::1", True), ("0.0.0.0", False)])
def test_the_loopback_is_known(host: str, so: bool) -> None:
    assert is_loopback(host) == so
    with pytest.raises(InputError, match="it must be an address of this machine"):
        is_loopback(f"{host}/")


def test_no_command_line_has_the_token_and_a_restarted_studio_knows_its_cookie(tmp_path: Path) -> None:
    told = tmp_path / "told"
    os.mkfifo(told)
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$@" > "{told}"\n')
    browser.chmod(0o700)
    studio = RunningStudio(tmp_path, "--browser", environment={"BROWSER": str(browser)})
    try:
        assert told.read_text() == f"{(studio.folder / 'open.html').as_uri()}\n"
        assert mode_of(studio.folder / "open.html") == 0o600
        assert studio.token in (studio.folder / "open.html").read_text()
        carries = "Cookie: {}={}".format(*studio.cookie)
        studio.close()
        assert not (studio.folder / "open.html").exists()
        (tmp_path / "told").unlink()
        studio.start()
        assert Intruder(studio.port, carries).ask("/").status == 200
    finally:
        studio.close()
