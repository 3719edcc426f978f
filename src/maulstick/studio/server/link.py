"""Link to the studio: its address in the network, and the token by which people come in."""

import os
import re
import secrets
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from html import escape
from ipaddress import ip_address
from pathlib import Path
from typing import Final

from maulstick.errors import InputError, OutputError, option

TOKEN_FILE: Final = "token"
"""File in the studio's folder that keeps its token; whoever deletes it gets a new one at the next start."""

_OPENING = "open.html"
_TOKEN = r"[A-Za-z0-9_-]{22,}"  # 128 bits and more
_ELSEWHERE = {"0.0.0.0": "192.0.2.1", "::": "2001:db8::1"}  # of nobody (RFC 5737, RFC 3849); nothing is sent there
_OF_PROGRAMS = ("docker", "br-", "veth", "virbr", "lxc")  # networks that exist within this machine alone


def is_loopback(host: str) -> bool:
    """Return whether this machine alone reaches the host. Raises InputError for what is no address."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        raise InputError(
            f"{option('host')} is {host!r}; it must be an address of this machine, as in 192.168.1.20, or 0.0.0.0"
        ) from None


def pages_at(host: str, port: int) -> str:
    """Return the address of the pages at a port, for another machine too where the host is no loopback."""
    reached = _address_in_network(host) if host in _ELSEWHERE else host
    return f"http://{f'[{reached}]' if ':' in reached else reached}:{port}/"


def link_to(host: str, port: int, token: str) -> str:
    """Return the link that leads in, from another machine too where the host is no loopback."""
    return f"{pages_at(host, port)}?token={token}"


def kept_token(root: Path) -> str:
    """Return the token of the studio in this folder, made at its first start; no other user can read its file.

    Raises OutputError where it cannot be kept.
    """
    path = root / TOKEN_FILE
    try:
        with suppress(FileNotFoundError, UnicodeDecodeError):
            if path.stat().st_uid != os.geteuid():
                raise FileNotFoundError  # somebody else knows it
            with suppress(PermissionError):  # of disks without permissions
                path.chmod(0o600)  # a copy of the folder may have lost that
            if re.fullmatch(_TOKEN, token := path.read_text("ascii").strip()):
                return token
        _write_privately(path, f"{(token := secrets.token_urlsafe(16))}\n")
    except OSError as error:
        raise OutputError(f"cannot keep the studio's token in {path}: {error.strerror}; mend that") from error
    return token


@contextmanager
def page_that_leads_to(link: str, root: Path) -> Iterator[str]:
    """Keep a page that leads on to the link in the folder meanwhile; yield its address.

    A browser is started with that address, since all users see with what a program was started, and the token is theirs
    then. Raises OutputError where the page cannot be written.
    """
    path, target = root / _OPENING, escape(link)
    page = (
        '<!doctype html>\n<meta charset="utf-8">\n<title>Maulstick</title>\n'
        f'<meta http-equiv="refresh" content="0; url={target}">\n<a href="{target}">Open the studio</a>\n'
    )
    try:
        _write_privately(path, page)
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror}; mend that") from error
    try:
        yield path.as_uri()
    finally:
        path.unlink(missing_ok=True)


def _write_privately(path: Path, text: str) -> None:
    """Write a new file that no other user can read at any moment."""
    path.unlink(missing_ok=True)
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)


def _address_in_network(host: str) -> str:
    """Return where others reach this machine: the address of its way out, else of its first network, else its name."""
    family = socket.AF_INET6 if host == "::" else socket.AF_INET
    with suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as way:
        way.connect((_ELSEWHERE[host], 9))
        return str(way.getsockname()[0])
    try:
        import ifaddr  # comes with what serves pages; links alone are made without
    except ImportError:
        return socket.gethostname()
    networks = [each for each in ifaddr.get_adapters() if not each.name.startswith(_OF_PROGRAMS)]
    addresses = [_plain(ip.ip) for network in networks for ip in network.ips if ip.is_IPv4 == (host == "0.0.0.0")]
    outer = [each for each in addresses if not (ip_address(each).is_loopback or ip_address(each).is_link_local)]
    return outer[0] if outer else socket.gethostname()


def _plain(ip: str | tuple[str, int, int]) -> str:
    return ip if isinstance(ip, str) else ip[0]
