"""What the validation layer and the driver say about the calls of one instance."""

from __future__ import annotations

from collections import deque

from lavapipe.errors import ValidationFailed

_VALIDATION = 2  # VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT
_LIMIT = 100


class Messages:
    """The latest warnings and errors, those of the validation layer apart from all others."""

    def __init__(self) -> None:
        self._validation: deque[str] = deque(maxlen=_LIMIT)
        self._driver: deque[str] = deque(maxlen=_LIMIT)

    def receive(self, kinds: int, text: str) -> None:
        """Take a message in; `kinds` are VkDebugUtilsMessageTypeFlagBitsEXT."""
        (self._validation if kinds & _VALIDATION else self._driver).append(text)

    def take_validation(self) -> tuple[str, ...]:
        """The validation layer's messages since the last call."""
        return _take(self._validation)

    def take_driver(self) -> tuple[str, ...]:
        """All other messages since the last call."""
        return _take(self._driver)

    def check(self) -> None:
        """Raise ValidationFailed with the messages of the validation layer, if there are any."""
        messages = self.take_validation()
        if messages:
            raise ValidationFailed(messages)


def _take(messages: deque[str]) -> tuple[str, ...]:
    taken = []
    while messages:
        taken.append(messages.popleft())
    return tuple(taken)
