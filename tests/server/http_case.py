"""A real server with an HTTP port, and a stock client of the wire to it."""

import contextlib
import hashlib
import http.client
import json
import pathlib
import socket
import struct
import subprocess
import tempfile
import unittest

from running_server import GENEROUS_END, RunningServer, binaries, wait_until

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRPC_WEB = {"Content-Type": "application/grpc-web+proto"}
# StreamMeshRequest { mesh { name } }: written by hand, as this is a stock client of the wire.
MESH_NAME = 1


def field(number, data):
    """A length-delimited field of protobuf."""
    size, length = len(data), b""
    while size > 127:
        length += bytes([size & 127 | 128])
        size >>= 7
    return bytes([number << 3 | 2]) + length + bytes([size]) + data


def framed(message):
    return b"\0" + struct.pack(">I", len(message)) + message


def frames(body):
    """(messages, trailers) of an answer."""
    messages, trailers = [], {}
    while body:
        size = struct.unpack(">I", body[1:5])[0]
        content = body[5:5 + size]
        if body[0] & 0x80:
            trailers = dict(line.split(": ", 1) for line in content.decode().splitlines())
        else:
            messages.append(content)
        body = body[5 + size:]
    return messages, trailers


class HttpTest(unittest.TestCase):
    options = ()
    listen = "127.0.0.1:0"
    host = "127.0.0.1"

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.prepare()
        cls.ball = cls.folder / "ball.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.05", cls.ball], check=True)
        cls.bytes = cls.ball.read_bytes()
        cls.digest = hashlib.sha256(cls.bytes).hexdigest()
        cls.server = cls.enterClassContext(RunningServer(
            cls.folder / "store", "--http-listen", "127.0.0.1:0", *cls.options, listen=cls.listen))
        cls.port = int(cls.server.ready["http"].rsplit(":", 1)[1])

    @classmethod
    def prepare(cls):
        """Makes the files that the options name."""

    def connection(self):
        connection = http.client.HTTPConnection(self.host, self.port, timeout=GENEROUS_END)
        self.addCleanup(connection.close)
        return connection

    def ask(self, method, path, body=None, headers=None):
        """(status, headers, body)."""
        connection = self.connection()
        connection.request(method, path, body, headers or {})
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()

    def json(self, method, path, body=None, headers=None):
        """(status, what the answer says)."""
        more = {"Content-Type": "application/json", **(headers or {})}
        text = None if body is None else json.dumps(body)
        status, _, answer = self.ask(method, path, text, more)
        return status, json.loads(answer)

    def call(self, method, message=b"", headers=None):
        """(messages, trailers) of a call over gRPC-Web."""
        status, _, body = self.ask("POST", f"/tetstream.v1.{method}", framed(message),
                                   {**GRPC_WEB, **(headers or {})})
        self.assertEqual(status, 200, body)
        return frames(body)

    def put(self, data, headers=None):
        def answer():
            """None where the server had answered and hung up before we had sent all of it."""
            with contextlib.suppress(ConnectionError):
                return self.ask("PUT", f"/v1/grids/{self.digest}", data, headers)
            return None

        status, _, body = wait_until(answer)
        return status, json.loads(body)

    def mesh_request(self):
        return field(MESH_NAME, field(1, f"grids/{self.digest}".encode()))

    def raw(self, data, until_closed=True):
        """What comes back for these bytes, until the server closes."""
        with socket.create_connection((self.host, self.port), GENEROUS_END) as connection:
            connection.sendall(data)
            said = b""
            while piece := connection.recv(65536):
                said += piece
                if not until_closed and b"\r\n\r\n" in said:
                    break
            return said

    def samples(self):
        return self.server.samples()
