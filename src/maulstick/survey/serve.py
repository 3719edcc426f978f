"""Server for the participants of one survey, and for nothing else."""

import os
import socket
from pathlib import Path

import uvicorn

from maulstick.errors import InputError, option
from maulstick.survey.app import participants


def listening(host: str, port: int) -> socket.socket:
    """Open a socket at that address. Raises InputError where it is not of this computer, or the port is not free."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except (socket.gaierror, UnicodeError) as error:
        raise InputError(f"there is no address {host}; choose one of this computer for {option('host')}") from error
    except (OSError, OverflowError) as error:
        reason = os.strerror(error.errno or 0) if isinstance(error, OSError) else str(error)
        raise InputError(
            f"cannot listen at {host}, port {port}: {reason}; choose another {option('port')}, "
            "or an address of this computer"
        ) from error


def serve(folder: Path, at: socket.socket) -> None:
    """Serve the survey in `folder` until Ctrl-C. Raises InputError where there is none."""
    pages = participants(folder, progressed=lambda: None)  # whoever wants to know asks for the results
    uvicorn.Server(uvicorn.Config(pages, log_level="error", access_log=False)).run(sockets=[at])
