"""The cache: shared by processes, bounded, and never in the way."""

import hashlib
import multiprocessing
import os
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from lavapipe import Cache, InvalidArgument, compile_glsl, default_cache
from lavapipe import compiler as compiler_module

SOURCE = "#version 450\nlayout(local_size_x = 1) in;\nvoid main() {}\n"


def value_of(key: str) -> bytes:
    return hashlib.sha256(key.encode()).digest() * 40


def test_values_come_back_in_the_next_process(tmp_path: Path) -> None:
    Cache(tmp_path).put("a", b"1")
    assert Cache(tmp_path).get("a") == b"1"
    assert Cache(tmp_path).get("b") is None


def test_many_at_once(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    values = {f"cell {i}": os.urandom(8) for i in range(3000)}
    cache.put_many(values)
    assert cache.get_many(list(values)) == values
    wanted = [*list(values)[::7][:400], "missing"]
    fastest = min(_seconds(lambda: cache.get_many(wanted)) for _ in range(5))
    assert fastest < 0.02


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def test_compile_is_cached_by_content(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache = Cache(tmp_path)
    first = compile_glsl(SOURCE, cache=cache)
    monkeypatch.setattr(compiler_module, "_run", lambda *_: pytest.fail("compiled again"))
    assert compile_glsl(SOURCE, cache=cache, name="other") == first
    with pytest.raises(pytest.fail.Exception):
        compile_glsl(SOURCE, cache=cache, defines={"A": 1})


def test_damaged_entry_is_rebuilt(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    first = compile_glsl(SOURCE, cache=cache)
    with sqlite3.connect(next(tmp_path.glob("*.sqlite3"))) as database:
        database.execute("UPDATE entry SET value = x'00010203'")
    database.close()
    assert compile_glsl(SOURCE, cache=cache) == first
    assert compile_glsl(SOURCE, cache=Cache(tmp_path)) == first


@pytest.mark.parametrize("damage", ["zeros", "text", "cut", "middle"])
def test_damaged_file_is_rebuilt(tmp_path: Path, damage: str) -> None:
    cache = Cache(tmp_path)
    keys = [f"k{i}" for i in range(200)]
    cache.put_many({key: value_of(key) for key in keys})
    cache.close()
    file = next(tmp_path.glob("*.sqlite3"))
    data = bytearray(file.read_bytes())
    if damage == "zeros":
        data[:] = bytes(len(data))
    elif damage == "text":
        data[:] = b"this is no database" * 1000
    elif damage == "cut":
        del data[len(data) // 2 :]
    else:
        data[4096 : len(data) - 4096] = os.urandom(len(data) - 8192)
    file.write_bytes(data)
    for _ in range(2):
        for key, value in cache.get_many(keys).items():
            assert value == value_of(key)
        cache.put("new", b"new")
    assert cache.get("new") == b"new"


@pytest.mark.parametrize("damage", [b"damage" * 2000, b""])
def test_an_open_cache_survives_damage_from_outside(tmp_path: Path, damage: bytes) -> None:
    cache = Cache(tmp_path)
    cache.put("a", b"1")
    next(tmp_path.glob("*.sqlite3")).write_bytes(damage)
    assert cache.get("a") in (None, b"1")
    for _ in range(3):
        cache.put("b", b"2")
    assert cache.get("b") == b"2"


def test_least_recently_used_goes_first(tmp_path: Path) -> None:
    cache = Cache(tmp_path, limit_bytes=1_000_000)
    for index in range(60):
        cache.put(f"k{index}", os.urandom(30_000))
        assert cache.get("k0") is not None
    assert cache.get("k59") is not None
    assert cache.get("k1") is None
    assert sum(file.stat().st_size for file in tmp_path.iterdir()) < 1_200_000


def test_value_over_the_limit_is_not_kept(tmp_path: Path) -> None:
    cache = Cache(tmp_path, limit_bytes=100_000)
    cache.put("small", b"1")
    cache.put("big", bytes(200_000))
    assert cache.get("big") is None
    assert cache.get("small") == b"1"
    with pytest.raises(InvalidArgument, match="limit_bytes"):
        Cache(tmp_path, limit_bytes=0)


def _write_and_read(folder: str, number: int) -> int:
    cache, wrong = Cache(Path(folder), limit_bytes=2_000_000), 0
    for index in range(60):
        key = f"k{(index * 7 + number) % 80}"
        cache.put(key, value_of(key))
        other = f"k{(index * 3 + number) % 80}"
        wrong += cache.get(other) not in (None, value_of(other))
    wrong += cache.get(key) != value_of(key)
    return wrong


def test_many_processes_write_at_once(tmp_path: Path) -> None:
    with multiprocessing.get_context("spawn").Pool(4) as pool:
        assert pool.starmap(_write_and_read, [(str(tmp_path), n) for n in range(4)]) == [0] * 4


def test_many_threads_write_at_once(tmp_path: Path) -> None:
    cache, wrong = Cache(tmp_path), []

    def work(number: int) -> None:
        for index in range(50):
            key = f"k{(index * 7 + number) % 80}"
            cache.put(key, value_of(key))
            if cache.get(key) != value_of(key):
                wrong.append(key)

    threads = [threading.Thread(target=work, args=(n,)) for n in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_no_folder_can_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    cache = Cache(tmp_path / "file" / "folder")
    cache.put("a", b"1")
    assert cache.get("a") is None
    assert compile_glsl(SOURCE, cache=cache)


def test_unwritable_folder_is_silent() -> None:
    cache = Cache(Path("/proc/none"))
    cache.put("a", b"1")
    assert cache.get_many(["a"]) == {}


def test_variable_names_the_folder_or_switches_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAMPLERSCOPE_CACHE_DIR", str(tmp_path))
    assert default_cache().path == tmp_path
    assert default_cache() is default_cache()
    monkeypatch.setenv("SAMPLERSCOPE_CACHE_DIR", "off")
    default_cache().put("a", b"1")
    assert default_cache().get("a") is None


def test_missing_home_is_silent(tmp_path: Path) -> None:
    script = "import lavapipe; c = lavapipe.default_cache(); c.put('a', b'1'); c.get('a'); print(c.path)"
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("SAMPLERSCOPE", "XDG", "HOME"))}
    environment["HOME"] = "/nonexistent"
    run = subprocess.run(
        [sys.executable, "-c", script], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stderr == ""
    assert not list(tmp_path.iterdir())
