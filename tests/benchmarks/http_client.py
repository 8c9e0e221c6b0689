"""A small HTTP/1.1 client on asyncio streams: keeps its connection and does little else, so that it measures the
server rather than itself.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator


class Connection:
    """A connection that is kept."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer

    @classmethod
    async def open(cls, port: int) -> Connection:
        return cls(*await asyncio.open_connection("127.0.0.1", port))

    async def get(self, path: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
        """Status, headers and body of a GET."""
        lines = [
            f"GET {path} HTTP/1.1",
            "Host: 127.0.0.1",
            *(f"{k.replace('_', '-')}: {v}" for k, v in headers.items()),
        ]
        self._writer.write(("\r\n".join(lines) + "\r\n\r\n").encode())
        head = (await self._reader.readuntil(b"\r\n\r\n")).decode().split("\r\n")
        found = {k.lower(): v.strip() for k, _, v in (line.partition(":") for line in head[1:] if line)}
        body = await self._reader.readexactly(int(found.get("content-length", 0)))
        return int(head[0].split()[1]), found, body

    async def close(self) -> None:
        self._writer.close()
        await self._writer.wait_closed()


async def timed(connections: list[Connection], paths: Iterator[str], seconds: float, **headers: str) -> list[float]:
    """Ask for paths in turn on all connections at once for so many seconds; the milliseconds of every answer."""
    taken: list[float] = []
    end = time.perf_counter() + seconds

    async def ask(connection: Connection) -> None:
        while (begin := time.perf_counter()) < end:
            status, _, _ = await connection.get(next(paths), **headers)
            taken.append(1e3 * (time.perf_counter() - begin))
            assert status in (200, 304), status

    await asyncio.gather(*(ask(connection) for connection in connections))
    return taken
