"""python -m service.worker: started by the server with an open socket, ends with it."""

from __future__ import annotations

import os
import signal
import socket
import sys

from service.worker.child import Worker


def main() -> None:
    """Serve the socket whose number is the first argument; the second is `device` or `no-device`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with socket.socket(fileno=int(sys.argv[1])) as connection:
        code = Worker(connection, with_device=sys.argv[2] == "device").run()
    # Threads of the driver may hang: the process ends without waiting for them.
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
