"""gRPC calls byte by byte, for clients that behave as no library would let them."""

import socket
import struct
import time

from running_server import GENEROUS_END

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
DATA, HEADERS, RST_STREAM, SETTINGS, PING, GOAWAY, WINDOW_UPDATE = 0, 1, 3, 4, 6, 7, 8
END_STREAM, END_HEADERS, ACK = 1, 4, 1
INITIAL_WINDOW_SIZE = 4
FIRST_WINDOW = 65535


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def text(name, value):
    """A header that no table knows, shorter than 127 bytes."""
    return b"\0" + bytes([len(name)]) + name.encode() + bytes([len(value)]) + value.encode()


def varint(number):
    encoded = b""
    while number > 127:
        encoded += bytes([number & 127 | 128])
        number >>= 7
    return encoded + bytes([number])


def field(number, value):
    """A protobuf field: of bytes or text, or a whole number."""
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    value = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(value)) + value


def double_field(number, value):
    return varint(number << 3 | 1) + struct.pack("<d", value)


def message(payload, compressed=False):
    """As gRPC sends it."""
    return struct.pack(">BI", compressed, len(payload)) + payload


class RawCall:
    """One call on a connection of its own. `ended` once the server ended it, or the connection.

    `window`: what the server may send before it is let; nothing more is ever let.
    `source`: the address it comes from, one of 127.0.0.0/8.
    `headers`: more of them, as pairs.
    `trailers` are the last headers that came, as they were encoded.
    """

    def __init__(self, port, method, window=FIRST_WINDOW, source="127.0.0.1", receive_buffer=None,
                 headers=()):
        self.ended = False
        self.trailers = b""
        self.window = {0: FIRST_WINDOW, 1: FIRST_WINDOW}  # what we may send
        self.first_window = FIRST_WINDOW
        self.received = b""
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.bind((source, 0))
        self.socket.connect(("127.0.0.1", port))
        self.socket.sendall(
            PREFACE + frame(SETTINGS, 0, 0, struct.pack(">HI", INITIAL_WINDOW_SIZE, window))
            + (frame(WINDOW_UPDATE, 0, 0, struct.pack(">I", window)) if window > FIRST_WINDOW
               else b"")
            + frame(HEADERS, END_HEADERS, 1, b"".join([
                text(":method", "POST"), text(":scheme", "http"), text(":path", method),
                text(":authority", "crowd"), text("te", "trailers"),
                text("content-type", "application/grpc"), *(text(*header) for header in headers)])))

    def ask(self, payload):
        """Sends the only message, which is small."""
        self.socket.sendall(frame(DATA, END_STREAM, 1, message(payload)))

    def finish(self):
        """Says that there are no more messages."""
        self.socket.sendall(frame(DATA, END_STREAM, 1))

    def send(self, data, seconds=GENEROUS_END):
        """Sends as much as the server lets us. Whether that was all."""
        end = time.monotonic() + seconds
        while data and not self.ended and time.monotonic() < end:
            size = min(len(data), 16384, self.window[0], self.window[1])
            if size <= 0:
                self.listen(0.05)
                continue
            self.socket.sendall(frame(DATA, 0, 1, data[:size]))
            data = data[size:]
            self.window[0] -= size
            self.window[1] -= size
            self.listen(0)
        return not data

    def listen(self, seconds):
        """Takes in what the server has sent, waiting for it no longer than that."""
        self.socket.settimeout(seconds or 0.0)
        try:
            received = self.socket.recv(1 << 20)
        except (BlockingIOError, TimeoutError):
            return
        except ConnectionError:
            received = b""
        finally:
            self.socket.settimeout(None)
        if not received:
            self.ended = True
        self.received += received
        self.take_frames()

    def take_frames(self):
        while len(self.received) >= 9:
            size = int.from_bytes(self.received[:3], "big")
            if len(self.received) < 9 + size:
                return
            kind, flags, stream = struct.unpack(">BBI", self.received[3:9])
            payload, self.received = self.received[9:9 + size], self.received[9 + size:]
            self.take(kind, flags, stream, payload)

    def take(self, kind, flags, stream, payload):
        if kind == SETTINGS and not flags & ACK:
            for at in range(0, len(payload), 6):
                key, value = struct.unpack(">HI", payload[at:at + 6])
                if key == INITIAL_WINDOW_SIZE:
                    self.window[1] += value - self.first_window
                    self.first_window = value
            self.socket.sendall(frame(SETTINGS, ACK, 0))
        elif kind == PING and not flags & ACK:
            self.socket.sendall(frame(PING, ACK, 0, payload))
        elif kind == WINDOW_UPDATE:
            self.window[stream] += int.from_bytes(payload, "big")
        elif kind == HEADERS and flags & END_STREAM or kind in (RST_STREAM, GOAWAY):
            self.trailers = payload if kind == HEADERS else self.trailers
            self.ended = True

    def wait_for_end(self, seconds=GENEROUS_END):
        end = time.monotonic() + seconds
        while not self.ended and time.monotonic() < end:
            self.listen(0.05)
        return self.ended

    def close(self):
        self.socket.close()
