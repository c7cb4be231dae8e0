"""``mat serve``: the service, in this process."""

from __future__ import annotations

import argparse
import socket

from service.cli.exits import OK, USAGE, Failure
from service.server import BACKLOG, run
from service.settings import InvalidSetting, Settings


def serve(asked: argparse.Namespace) -> int:
    """Serve until a signal asks for the end."""
    try:
        settings = Settings.from_environment()
    except InvalidSetting as error:
        raise Failure(USAGE, str(error)) from error
    run(settings, listen(asked.host, asked.port))
    return OK


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens on an address."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        made = socket.create_server((address[0], port), family=family, backlog=BACKLOG)
    except OSError as error:
        raise Failure(USAGE, f"port {port} of {host} cannot be used: {error.strerror}") from error
    # asyncio turns off Nagle's algorithm (which holds back the second part of an answer for 40 ms) only for sockets that say TCP
    return socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP, fileno=made.detach())
