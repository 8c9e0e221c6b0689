"""Lifetimes: every Vulkan thing is a context manager, is closed once, and outlives the work that uses it."""

from __future__ import annotations

import os
import threading
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from lavapipe.errors import InvalidArgument, LavapipeError


class Resource:
    """A thing that belongs to a device and is closed at the latest with it.

    Closing is idempotent. Where submitted work still uses the thing, it counts as closed at once and its Vulkan
    objects go when that work is done.
    """

    def __init__(self, owner: Owner, kind: str, teardown: ExitStack) -> None:
        self._owner = owner
        self._kind = kind
        self._closed = False
        self._users = 0
        self._teardown = teardown.pop_all()
        owner.add(self)

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._closed

    def close(self) -> None:
        """Give it back; again is harmless."""
        with self._owner.lock:
            if self._closed:
                return
            self._closed = True
            if self._users == 0:
                self._release()

    def check_open(self) -> None:
        """Raise InvalidArgument if it was closed."""
        self._owner.check_process()
        if self._closed:
            raise InvalidArgument(f"this {self._kind} is closed")

    def belongs_to(self, owner: Owner) -> bool:
        """Whether this owner's device made it."""
        return self._owner is owner

    def hold(self) -> None:
        """Keep its Vulkan objects, closed or not, until as many calls of `let_go`."""
        with self._owner.lock:
            self._users += 1

    def let_go(self) -> None:
        """Undo one `hold`."""
        with self._owner.lock:
            self._users -= 1
            if self._closed and self._users == 0:
                self._release()

    def _release(self) -> None:
        self._owner.remove(self)
        if self._owner.same_process:
            self._teardown.close()

    def __enter__(self) -> Self:
        self.check_open()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Owner:
    """What a device owns, in order of creation."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self._things: dict[int, Resource] = {}
        self._process = os.getpid()

    def __len__(self) -> int:
        return len(self._things)

    @property
    def same_process(self) -> bool:
        """False in a forked child: the driver's threads stayed with the parent, and a call would hang."""
        return os.getpid() == self._process

    def check_process(self) -> None:
        """Raise LavapipeError in a forked child."""
        if not self.same_process:
            raise LavapipeError("this device was opened before a fork: open one in the child process")

    def add(self, thing: Resource) -> None:
        """Own this."""
        with self.lock:
            self._things[id(thing)] = thing

    def remove(self, thing: Resource) -> None:
        """Own this no longer."""
        with self.lock:
            self._things.pop(id(thing), None)

    def close_all(self) -> None:
        """Close in reverse order of creation; the first error is raised when all are closed."""
        errors: list[LavapipeError] = []
        while self._things:
            with self.lock:
                thing = list(self._things.values())[-1]
            try:
                thing.close()
            except LavapipeError as error:
                errors.append(error)
            self.remove(thing)
        if errors:
            raise errors[0]
