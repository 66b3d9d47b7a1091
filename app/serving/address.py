"""The sockets that a host and a port stand for."""

from __future__ import annotations

import socket


class CannotListen(Exception):
    """The address cannot be had; the message says why."""


def bound_sockets(host: str, port: int) -> list[socket.socket]:
    """A bound socket for each address of a host, not listening yet.

    Args:
        host: Name or number; all its addresses are taken.
        port: Port; 0 takes a free one, the same for all.

    Raises:
        CannotListen: An address is taken, not this machine's, or there is none.
    """
    try:
        found = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE | socket.AI_NUMERICSERV
        )
    except (OSError, UnicodeError) as error:
        raise CannotListen(f"{host!r} is no address: {error}") from None
    sockets: list[socket.socket] = []
    for family, kind, protocol, _, address in dict.fromkeys(found):
        one = socket.socket(family, kind, protocol)
        sockets.append(one)
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            one.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        try:
            one.bind((address[0], port or port_of(sockets[0]), *address[2:]))
        except OSError as error:
            for opened in sockets:
                opened.close()
            raise CannotListen(
                f"cannot listen on {host}, port {port}: {error.strerror}; choose another with"
                " --host and --port"
            ) from None
    return sockets


def port_of(bound: socket.socket) -> int:
    """The port of a bound socket; 0 before it is bound."""
    return int(bound.getsockname()[1])
