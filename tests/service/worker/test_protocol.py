"""Messages between server and worker arrive whole, whatever pieces they come in; what is no message is refused."""

import socket

import pytest

from service.worker.protocol import Message, Unpacker, receive

MESSAGES = [
    Message({"do": "answer", "id": 1, "scene": {"model": "eon", "unit": "°"}}),
    Message({"do": "encode", "id": 2}, (b"", b"\x00\xff" * 500, b"end")),
    Message({}),
]
STREAM = b"".join(message.packed() for message in MESSAGES)


@pytest.mark.parametrize("size", [1, 7, 8, 9, 100, len(STREAM)])
def test_messages_arrive_in_pieces_of_any_size(size):
    unpacker = Unpacker()
    pieces = [STREAM[start : start + size] for start in range(0, len(STREAM), size)]
    assert [message for piece in pieces for message in unpacker.feed(piece)] == MESSAGES


def test_messages_are_received_one_by_one_until_the_other_side_ends():
    ours, theirs = socket.socketpair()
    with ours:
        with theirs:
            theirs.sendall(STREAM)
        assert [receive(ours) for _ in range(4)] == [*MESSAGES, None]


def test_a_message_cut_short_is_none():
    ours, theirs = socket.socketpair()
    with ours:
        with theirs:
            theirs.sendall(MESSAGES[1].packed()[:-1])
        assert receive(ours) is None


@pytest.mark.parametrize(
    "nonsense",
    [
        b"\xff" * 8,  # longer than any message
        b"\x02\x00\x00\x00\x00\x00\x00\x00{]",
        b"\x02\x00\x00\x00\x00\x00\x00\x00[]",
    ],
)
def test_what_is_no_message_is_refused(nonsense):
    with pytest.raises((ValueError, TypeError)):
        list(Unpacker().feed(nonsense))
