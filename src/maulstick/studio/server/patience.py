"""Patience with connections: a request that does not come whole in time is given up, and nobody has too many.

There is always room for one more, which may be STOP.
"""

import asyncio
import resource
from operator import itemgetter
from typing import Any, final

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

LONGEST = 10.0
"""Seconds that a request's head may take to come."""

MOST = 256
"""Connections from one address: some forty pages with all that they load."""


def room() -> float:
    """Return the number of connections that are kept: half of the files that this process may have open."""
    most, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return float("inf") if most == resource.RLIM_INFINITY else most // 2


@final
class TimelyProtocol(HttpToolsProtocol):
    """HTTP of uvicorn, which by itself waits for the end of a request's head for ever."""

    _late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, unless the address has too many connections."""
        super().connection_made(transport)
        if self.client is not None and sum(self._is_of_the_same(other) for other in self.connections) > MOST:
            transport.abort()
            return
        if len(self.connections) > room():
            self._make_room()
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Take in what came, and wait for the rest of it."""
        super().data_received(data)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._forget()
        super().connection_lost(exc)

    def _make_room(self) -> None:
        """Close the connection that has waited longest for a request, if any waits."""
        waiting = [
            (other._late.when(), other)
            for other in self.connections
            if isinstance(other, TimelyProtocol) and other._late is not None
        ]
        if waiting:
            min(waiting, key=itemgetter(0))[1].transport.abort()

    @property
    def _is_waiting(self) -> bool:
        return self.cycle is None or self.cycle.response_complete

    def _wait(self) -> None:
        if not self._is_waiting:
            self._forget()
        elif self._late is None:
            self._late = self.loop.call_later(LONGEST, self._give_up)

    def _forget(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None

    def _give_up(self) -> None:
        self._late = None
        if self._is_waiting and self.transport.get_protocol() is self:  # and not a websocket by now
            self.transport.close()

    def _is_of_the_same(self, other: Any) -> bool:
        client = getattr(other, "client", None)
        return client is not None and self.client is not None and client[0] == self.client[0]
