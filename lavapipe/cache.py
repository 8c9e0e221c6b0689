"""A cache of bytes by key, on disk, shared by any number of processes.

It may be lost at any time: whatever is wrong with it (no writable folder, a damaged file, a full disk) looks like a
value that was never stored.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import hashlib
import os
import sqlite3
import threading
import time
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from lavapipe.errors import InvalidArgument

_VARIABLE = "SAMPLERSCOPE_CACHE_DIR"
_FILE = "cache-1.sqlite3"
_BUSY_S = 2.0
_FLUSH_AFTER = 1000
_KEYS_A_QUERY = 500
_SCHEMA = """
CREATE TABLE IF NOT EXISTS entry (
    key TEXT PRIMARY KEY, used INTEGER NOT NULL, digest BLOB NOT NULL, value BLOB NOT NULL
);
CREATE INDEX IF NOT EXISTS entry_used ON entry (used);
"""


class Cache:
    """Bytes by key in a folder, of at most `limit_bytes` in all; what was used least recently goes first.

    `path` is the folder, by default the user's cache folder. Safe for many threads and processes at once. A value
    comes back as it was stored or not at all: each carries a digest. No method raises for trouble with the disk.
    """

    def __init__(self, path: Path | None = None, limit_bytes: int = 256 << 20) -> None:
        if limit_bytes <= 0:
            raise InvalidArgument(f"limit_bytes={limit_bytes}: a positive number of bytes")
        self.path: Path | None = _user_folder() if path is None else Path(path)
        self.limit_bytes = limit_bytes
        self._lock = threading.RLock()
        self._connection: sqlite3.Connection | None = None
        self._process = 0
        self._touched: dict[str, int] = {}

    @classmethod
    def disabled(cls) -> Cache:
        """A cache that keeps nothing."""
        cache = cls(Path())
        cache.path = None
        return cache

    def get(self, key: str) -> bytes | None:
        """The value of this key, or None."""
        return self.get_many([key]).get(key)

    def put(self, key: str, value: bytes) -> None:
        """Store a value; one that is larger than the limit is not kept."""
        self.put_many({key: value})

    def get_many(self, keys: Collection[str]) -> dict[str, bytes]:
        """The values of those keys that are there."""
        wanted, found, damaged = list(keys), {}, []
        with self._trouble_is_a_miss(), self._lock:
            database = self._database()
            if database is None:
                return {}
            for start in range(0, len(wanted), _KEYS_A_QUERY):
                part = wanted[start : start + _KEYS_A_QUERY]
                marks = ",".join("?" * len(part))
                rows = database.execute(f"SELECT key, digest, value FROM entry WHERE key IN ({marks})", part)
                for key, digest, value in rows:
                    if isinstance(value, bytes) and digest == _digest(key, value):
                        found[key] = value
                    else:
                        damaged.append((key,))
            self._touched.update(dict.fromkeys(found, time.time_ns()))
            if damaged:
                database.executemany("DELETE FROM entry WHERE key = ?", damaged)
            if len(self._touched) > _FLUSH_AFTER:
                with _transaction(database):
                    self._write_touched(database)
        return found

    def put_many(self, values: Mapping[str, bytes]) -> None:
        """Store these values in one go."""
        now = time.time_ns()
        rows = [(k, now, _digest(k, v), v) for k, v in values.items() if len(v) <= self.limit_bytes]
        with self._trouble_is_a_miss(), self._lock:
            database = self._database()
            if database is None or not rows:
                return
            with _transaction(database):
                self._write_touched(database)
                database.executemany("INSERT OR REPLACE INTO entry VALUES (?, ?, ?, ?)", rows)
                self._evict(database)

    def close(self) -> None:
        """Let go of the file; the cache opens it again when it is used again."""
        with self._trouble_is_a_miss(), self._lock:
            if self._connection is not None and self._process == os.getpid():
                try:
                    if self._touched:
                        with _transaction(self._connection):
                            self._write_touched(self._connection)
                finally:
                    self._connection.close()
            self._connection = None

    def _write_touched(self, database: sqlite3.Connection) -> None:
        """Note what was read, with the next write: a read that had to write would make readers wait for each other."""
        touched, self._touched = self._touched, {}
        database.executemany("UPDATE entry SET used = ? WHERE key = ?", [(when, key) for key, when in touched.items()])

    def _evict(self, database: sqlite3.Connection) -> None:
        excess = _bytes_in_use(database) - self.limit_bytes
        if excess <= 0:
            return
        # A tenth more than needed, so that not every later write has to evict.
        excess += self.limit_bytes // 10
        doomed = []
        for key, size in database.execute("SELECT key, length(value) FROM entry ORDER BY used"):
            if excess <= 0:
                break
            doomed.append((key,))
            excess -= size + 100
        database.executemany("DELETE FROM entry WHERE key = ?", doomed)

    def _database(self) -> sqlite3.Connection | None:
        if self.path is None:
            return None
        if self._connection is None or self._process != os.getpid():
            # A connection must not cross a fork: its locks would be the parent's.
            self._process = os.getpid()
            self._connection = _open(self.path / _FILE)
        return self._connection

    @contextlib.contextmanager
    def _trouble_is_a_miss(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.OperationalError:
            # Busy, full, read-only, no such folder, or no such table because the file was replaced: a fresh
            # connection finds out.
            self._disconnect()
        except (sqlite3.DatabaseError, OSError, UnicodeError):
            self._discard()

    def _discard(self) -> None:
        """Remove a damaged file; the next use makes a new one."""
        self._disconnect()
        if self.path is not None:
            _remove(self.path / _FILE)

    def _disconnect(self) -> None:
        with self._lock, contextlib.suppress(sqlite3.Error):
            connection, self._connection = self._connection, None
            if connection is not None:
                connection.close()


def default_cache() -> Cache:
    """The user's cache, one for the process.

    Its folder is that of SAMPLERSCOPE_CACHE_DIR where that is set ("off": no cache), else the user's cache folder.
    """
    return _default(os.environ.get(_VARIABLE, ""))


@functools.lru_cache(maxsize=4)
def _default(setting: str) -> Cache:
    if setting == "off":
        return Cache.disabled()
    cache = Cache(Path(setting)) if setting else Cache()
    atexit.register(cache.close)
    return cache


def _user_folder() -> Path | None:
    import platformdirs

    folder = Path(platformdirs.user_cache_dir("samplerscope"))
    # Without a home the folder stays "~/.cache", which would be relative to wherever the process runs.
    return folder if folder.is_absolute() else None


def _open(file: Path) -> sqlite3.Connection:
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    try:
        return _connected(file)
    except sqlite3.OperationalError:
        raise
    except sqlite3.DatabaseError:
        _remove(file)
        return _connected(file)


def _remove(file: Path) -> None:
    for suffix in ("", "-journal"):
        with contextlib.suppress(OSError):
            Path(f"{file}{suffix}").unlink()


def _connected(file: Path) -> sqlite3.Connection:
    database = sqlite3.connect(file, timeout=_BUSY_S, isolation_level=None, check_same_thread=False)
    try:
        # Losing entries in a power cut is fine, waiting for the disk is not.
        database.execute("PRAGMA synchronous = OFF")
        database.executescript(_SCHEMA)
    except BaseException:
        database.close()
        raise
    return database


@contextlib.contextmanager
def _transaction(database: sqlite3.Connection) -> Iterator[None]:
    # IMMEDIATE: a transaction that starts by reading cannot wait for a writer, it fails at once.
    database.execute("BEGIN IMMEDIATE")
    try:
        yield
    except BaseException:
        with contextlib.suppress(sqlite3.Error):
            database.execute("ROLLBACK")
        raise
    database.execute("COMMIT")


def _bytes_in_use(database: sqlite3.Connection) -> int:
    pages, free, size = (
        database.execute(f"PRAGMA {name}").fetchone()[0] for name in ("page_count", "freelist_count", "page_size")
    )
    return int((pages - free) * size)


def _digest(key: str, value: bytes) -> bytes:
    return hashlib.sha256(key.encode() + b"\0" + value).digest()[:16]
