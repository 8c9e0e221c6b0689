"""Results, jobs and checkpoints in one SQLite file, bounded in size and age.

Results are found by what was asked (a hash of scene, shader text, driver and version) and keep their bytes. What is
written is whole or not there: every method is one transaction.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import logging
import os
import sqlite3
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from service.errors import BadInput, Problem

_FILE = "results-1.sqlite3"
_LOCK = "server.lock"
_SCHEMA = """
CREATE TABLE IF NOT EXISTS result (
    key TEXT PRIMARY KEY, etag TEXT NOT NULL, content BLOB NOT NULL, used REAL NOT NULL, created REAL NOT NULL
);
CREATE INDEX IF NOT EXISTS result_used ON result (used);
CREATE INDEX IF NOT EXISTS result_created ON result (created);
CREATE TABLE IF NOT EXISTS total (bytes INTEGER NOT NULL);
INSERT INTO total SELECT IFNULL((SELECT SUM(LENGTH(content)) FROM result), 0) WHERE NOT EXISTS (SELECT 1 FROM total);
CREATE TRIGGER IF NOT EXISTS result_came AFTER INSERT ON result BEGIN
    UPDATE total SET bytes = bytes + LENGTH(NEW.content);
END;
CREATE TRIGGER IF NOT EXISTS result_went AFTER DELETE ON result BEGIN
    UPDATE total SET bytes = bytes - LENGTH(OLD.content);
END;
CREATE TABLE IF NOT EXISTS job (
    id TEXT PRIMARY KEY, key TEXT NOT NULL, kind TEXT NOT NULL, scene TEXT NOT NULL, state TEXT NOT NULL,
    created REAL NOT NULL, updated REAL NOT NULL, done INTEGER NOT NULL, total INTEGER NOT NULL,
    estimate_s REAL NOT NULL, error TEXT
);
CREATE INDEX IF NOT EXISTS job_created ON job (created);
CREATE INDEX IF NOT EXISTS job_state ON job (state, updated, id);
CREATE TABLE IF NOT EXISTS checkpoint (
    job TEXT NOT NULL REFERENCES job (id) ON DELETE CASCADE, run TEXT NOT NULL, sums BLOB NOT NULL,
    PRIMARY KEY (job, run)
);
"""
UNFINISHED = ("queued", "running")
PRUNED_AT_ONCE = 1000
"""Rows that go at a time, at most: others wait meanwhile."""

_log = logging.getLogger("samplerscope.store")


@dataclass(frozen=True)
class Stored:
    """Bytes with their strong entity tag, a hash of them."""

    content: bytes
    etag: str

    @classmethod
    def of(cls, content: bytes) -> Stored:
        """Bytes, tagged."""
        return cls(content, f'"{hashlib.blake2b(content, digest_size=16).hexdigest()}"')


@dataclass(frozen=True)
class Job:
    """A question being answered in the background. Times are seconds since 1970; `error` is a problem."""

    id: str
    key: str
    kind: str
    scene: Mapping[str, Any]
    state: str
    created: float
    updated: float
    done: int
    total: int
    estimate_s: float
    error: Mapping[str, Any] | None = None

    @property
    def finished(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state not in UNFINISHED


class Store:
    """The store in a folder. One server at a time: BadInput where another one has it, or it cannot be written."""

    def __init__(self, folder: Path, limit_bytes: int, max_age_s: float, max_jobs: int) -> None:
        self._limit_bytes = limit_bytes
        self._max_age_s = max_age_s
        self._max_jobs = max_jobs
        self._mutex = threading.Lock()
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._lock: int | None = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise BadInput(
                Problem("data_dir", str(folder), f"a folder that can be written ({error.strerror})")
            ) from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._lock)
            raise BadInput(Problem("data_dir", str(folder), "a folder that no other server is using")) from None
        self._database = _open(folder / _FILE)
        self.prune()

    def close(self) -> None:
        """Close the file and give the folder free; again is harmless."""
        with self._mutex:
            self._database.close()
            if self._lock is not None:
                os.close(self._lock)
                self._lock = None

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        with self._mutex, self._database:
            self._database.execute("BEGIN IMMEDIATE")
            yield self._database

    def keys(self) -> set[str]:
        """The keys of all stored results."""
        with self._mutex:
            return {key for (key,) in self._database.execute("SELECT key FROM result")}

    def result(self, key: str) -> Stored | None:
        """The stored bytes of this key."""
        with self._mutex:
            row = self._database.execute("SELECT content, etag FROM result WHERE key = ?", (key,)).fetchone()
            if row is None:
                return None
            try:
                self._database.execute("UPDATE result SET used = ? WHERE key = ?", (time.time(), key))
            except sqlite3.OperationalError as error:  # a full disk can be read
                _log.error("the use of a result could not be noted: %s", error)
        return Stored(bytes(row[0]), row[1])

    def keep_results(self, results: Mapping[str, Stored]) -> None:
        """Store bytes by their keys. Where some are stored already, those stay: equal questions get equal bytes."""
        with self._transaction() as database:
            _insert(database, results)

    def prune(self) -> set[str]:
        """Forget what is too old, and what was used least recently above the limits of size and number: some of it,
        and more the next time. Takes no longer where much is stored. Returns the keys of results that went.
        """
        oldest = time.time() - self._max_age_s
        unfinished = ",".join(f"'{state}'" for state in UNFINISHED)
        some = f"LIMIT {PRUNED_AT_ONCE}"
        with self._transaction() as database:
            gone = database.execute(f"SELECT key FROM result WHERE created < ? {some}", (oldest,)).fetchall()
            database.executemany("DELETE FROM result WHERE key = ?", gone)
            (total,) = database.execute("SELECT bytes FROM total").fetchone()
            least_used = self._least_used(total - self._limit_bytes)
            database.executemany("DELETE FROM result WHERE key = ?", least_used)
            finished = f"SELECT id FROM job WHERE state NOT IN ({unfinished})"
            database.execute(f"DELETE FROM job WHERE id IN ({finished} AND updated < ? {some})", (oldest,))
            database.execute(
                f"DELETE FROM job WHERE id IN ({finished} ORDER BY updated DESC {some} OFFSET ?)", (self._max_jobs,)
            )
        return {key for (key,) in (*gone, *least_used)}

    def _least_used(self, excess: int) -> list[tuple[str]]:
        """Keys of results that have so many bytes together, least recently used first."""
        found: list[tuple[str]] = []
        for key, size in self._database.execute(
            f"SELECT key, LENGTH(content) FROM result ORDER BY used LIMIT {PRUNED_AT_ONCE}"
        ):
            if excess <= 0:
                break
            found.append((key,))
            excess -= size
        return found

    def keep_job(self, job: Job) -> None:
        """Store a new job, or what became of one. A finished one loses its checkpoints."""
        with self._transaction() as database:
            _upsert(database, job)

    def finish_job(self, job: Job, stored: Stored) -> None:
        """Store a job's result and that it is done, as :meth:`keep_results` and :meth:`keep_job` do."""
        with self._transaction() as database:
            _insert(database, {job.key: stored})
            _upsert(database, replace(job, state="done", updated=time.time()))

    def keep_checkpoint(self, job: Job, run: str, sums: bytes) -> None:
        """Store how far a run of a job is, and the job's progress."""
        with self._transaction() as database:
            database.execute(
                "INSERT OR REPLACE INTO checkpoint (job, run, sums) "
                "SELECT id, ?, ? FROM job WHERE id = ? AND state IN ('queued', 'running')",
                (run, sums, job.id),
            )
            database.execute("UPDATE job SET done = ?, updated = ? WHERE id = ?", (job.done, job.updated, job.id))

    def checkpoints(self, job_id: str) -> dict[str, bytes]:
        """The stored checkpoints of a job, by run."""
        with self._mutex:
            rows = self._database.execute("SELECT run, sums FROM checkpoint WHERE job = ?", (job_id,)).fetchall()
        return {run: bytes(sums) for run, sums in rows}

    def job(self, job_id: str) -> Job | None:
        """The job of this id."""
        return next(iter(self._jobs("WHERE id = ?", job_id)), None)

    def jobs(self, limit: int) -> list[Job]:
        """The latest jobs, newest first."""
        return self._jobs("ORDER BY created DESC LIMIT ?", limit)

    def unfinished_jobs(self) -> list[Job]:
        """Jobs to go on with, oldest first."""
        return self._jobs("WHERE state IN (?, ?) ORDER BY created", *UNFINISHED)

    def _jobs(self, clause: str, *values: Any) -> list[Job]:
        with self._mutex:
            cursor = self._database.execute(f"SELECT * FROM job {clause}", values)
            names = [column[0] for column in cursor.description]
            rows = [dict(zip(names, row, strict=True)) for row in cursor.fetchall()]
        return [
            Job(**{**row, "scene": json.loads(row["scene"]), "error": row["error"] and json.loads(row["error"])})
            for row in rows
        ]


def _insert(database: sqlite3.Connection, results: Mapping[str, Stored]) -> None:
    now = time.time()
    rows = [(key, stored.etag, stored.content, now, now) for key, stored in results.items()]
    database.executemany("INSERT OR IGNORE INTO result (key, etag, content, used, created) VALUES (?,?,?,?,?)", rows)


def _upsert(database: sqlite3.Connection, job: Job) -> None:
    row = {**vars(job), "scene": json.dumps(job.scene), "error": job.error and json.dumps(job.error)}
    columns = ", ".join(row)
    values = ", ".join(f":{name}" for name in row)
    changed = ", ".join(f"{name} = :{name}" for name in ("state", "updated", "done", "total", "error"))
    database.execute(f"INSERT INTO job ({columns}) VALUES ({values}) ON CONFLICT (id) DO UPDATE SET {changed}", row)
    if job.finished:
        database.execute("DELETE FROM checkpoint WHERE job = ?", (job.id,))


def _open(file: Path) -> sqlite3.Connection:
    """Open the file. A damaged one is put aside: the service starts with nothing stored rather than not at all."""
    try:
        return _connected(file)
    except sqlite3.OperationalError:
        raise
    except sqlite3.DatabaseError as error:
        _log.error("the stored results are damaged (%s); put aside as %s.damaged", error, file.name)
        file.replace(f"{file}.damaged")
        for suffix in ("-wal", "-shm"):
            Path(f"{file}{suffix}").unlink(missing_ok=True)
        return _connected(file)


def _connected(file: Path) -> sqlite3.Connection:
    database = sqlite3.connect(file, isolation_level=None, check_same_thread=False)
    try:
        # A power cut may cost the last second, never the file: a checkpoint is not worth a wait for the disk.
        database.executescript("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON;")
        database.executescript(_SCHEMA)
        database.execute("SELECT COUNT(*) FROM result").fetchone()
    except BaseException:
        database.close()
        raise
    return database
