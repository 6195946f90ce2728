"""What strangers do to the HTTP port of a real server: no requests, half ones, crowds, other pages.

    TETSTREAM_BIN=build/release/bin python3 tests/server/http_strangers_test.py [unittest options]
"""

import contextlib
import os
import pathlib
import socket
import struct
import threading
import unittest

from http_case import HttpTest, MESH_NAME, field, framed
from running_server import GENEROUS_END, wait_until


ROOM = 8 << 20  # for what is received over HTTP, where --receive-bytes is twice that
POST = (b"POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        b"Content-Length: %d\r\n\r\n")
HEALTH = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
LARGE = b"{" + b" " * 100_000  # more than a question, and no JSON


class Guests(HttpTest):
    """Those who come without a client that knows what to do."""

    def answers(self, data):
        """The status that comes for these bytes, or None where the server hangs up."""
        try:
            with socket.create_connection((self.host, self.port), GENEROUS_END) as connection:
                connection.sendall(data)
                said = connection.recv(64)
        except ConnectionError:
            return None
        return int(said.split()[1]) if said else None

    def begin(self, size, sent):
        """A body that never comes to its end."""
        connection = socket.create_connection((self.host, self.port), GENEROUS_END)
        self.addCleanup(connection.close)
        with contextlib.suppress(ConnectionError):  # where it took longer than it may
            connection.sendall(POST % size + bytes(sent))
        return connection


class Strangers(Guests):
    """What no browser of ours does."""

    options = ("--stall-seconds", "3", "--max-http-connections", "64", "--receive-bytes", "16MiB")

    def status_of(self, data):
        """Asked again where nothing comes back: it took longer to ask than one may."""
        return int(wait_until(lambda: self.raw(data)).split(b" ", 2)[1])

    def test_no_request_is_read_in_two_ways(self):
        get = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
        for head, status in (
                (get + b"Content-Length: 1\r\nContent-Length: 2\r\n\r\n", 400),
                (get + b"Content-Length: 0\r\nTransfer-Encoding: chunked\r\n\r\n", 501),
                (get + b"Transfer-Encoding: xchunked\r\n\r\n", 501),
                (get + b"Content-Length: +1\r\n\r\n", 400),
                (get + b"Content-Length: 1e2\r\n\r\n", 400),
                (get + b"Content-Length: 99999999999999999999\r\n\r\n", 400),
                (get + b"X: a\r\n folded\r\n\r\n", 400),
                (get + b"X : a\r\n\r\n", 400),
                (get + b"X: a\nY: b\r\n\r\n", 400),
                (get + b"X: \0\r\n\r\n", 400),
                (get + b"Host: other\r\n\r\n", 400),
                (b"GET /healthz HTTP/1.1\r\n\r\n", 400),
                (b"GET /healthz HTTP/1.0\r\nHost: a\r\n\r\n", 505),
                (b"GET http://a/ HTTP/1.1\r\nHost: a\r\n\r\n", 400),
                (b"GET  /healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
                (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505)):
            with self.subTest(head=head):
                self.assertEqual(self.status_of(head), status)

    def test_heads_have_an_end(self):
        get = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
        self.assertEqual(self.status_of(get + b"X: " + b"a" * 20000 + b"\r\n\r\n"), 431)
        self.assertEqual(self.status_of(get + b"A: b\r\n" * 100 + b"\r\n"), 431)
        self.assertEqual(self.status_of(b"GET /" + b"a" * 5000 + b" HTTP/1.1\r\nHost: a\r\n\r\n"), 414)

    def test_bodies_have_an_end(self):
        status, _, body = self.ask("POST", "/v1/jobs", None, {
            "Content-Type": "application/json", "Content-Length": str(1 << 40)})
        self.assertEqual(status, 413, body)

    def test_a_slow_sender_is_not_waited_for(self):
        said = self.raw(b"POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\n"
                        b"Content-Type: application/json\r\nContent-Length: 100\r\n\r\n{")
        self.assertIn(b" 408 ", said.split(b"\r\n")[0])

    def test_who_was_refused_leaves_the_room_to_others(self):
        size = 2 << 20
        late = [self.begin(size, size - 1) for _ in range(ROOM // size)]
        for connection in late:
            with contextlib.suppress(ConnectionError):
                self.assertIn(b" 408 ", connection.recv(64))

        def is_answered():
            status = self.answers(POST % len(LARGE) + LARGE)
            self.assertNotEqual(status, 503)
            return status == 400

        wait_until(is_answered)

    def test_a_stream_that_nobody_reads_ends_after_a_while(self):
        wait_until(lambda: self.put(self.bytes)[0] == 200)  # if it stands still, it begins again
        request = field(MESH_NAME, field(1, f"grids/{self.digest}".encode()) +
                        b"\x19" + struct.pack("<d", 0.008))
        with socket.socket() as stuck:
            stuck.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            stuck.connect((self.host, self.port))
            stuck.sendall(b"POST /tetstream.v1.MeshService/StreamMesh HTTP/1.1\r\nHost: localhost\r\n"
                          b"Content-Type: application/grpc-web+proto\r\nx-request-id: stuck\r\n"
                          b"Content-Length: %d\r\n\r\n" % (len(request) + 5) + framed(request))
            wait_until(lambda: [line for line in self.server.log("call")
                                if line["request_id"] == "stuck" and line["status"] != "OK"])
        line = next(line for line in self.server.log("call") if line["request_id"] == "stuck")
        self.assertIn(line["reason"], ("CLIENT_STALLED", "CANCELLED"))

    def test_idle_connections_harm_nobody(self):
        before = len(os.listdir(f"/proc/{self.server.process.pid}/task"))
        idle = []
        for _ in range(1000):
            connection = socket.create_connection((self.host, self.port), GENEROUS_END)
            idle.append(connection)
            self.addCleanup(connection.close)
        self.assertEqual(self.ask("GET", "/healthz")[0], 200)
        self.assertLessEqual(self.samples()["tetstream_http_connections"], 64)
        after = len(os.listdir(f"/proc/{self.server.process.pid}/task"))
        self.assertLess(after, before + 32)

    def test_requests_behind_each_other_are_answered_in_turn(self):
        get = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n"
        said = self.raw((get + b"\r\n") * 500 + get + b"Connection: close\r\n\r\n")
        self.assertEqual(said.count(b"HTTP/1.1 200 OK"), 501)

    def test_every_answer_says_what_a_page_may_do(self):
        for path in ("/healthz", "/nothing", "/v1/openapi.json", "/v1/jobs"):
            _, headers, _ = self.ask("GET", path)
            self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIsNone(headers["Set-Cookie"])
            self.assertIsNone(headers["Access-Control-Allow-Origin"])

    def test_pages_from_elsewhere_may_not_ask(self):
        for headers, status in (({"Origin": "https://evil.example"}, 403),
                                ({"Origin": "null"}, 403),
                                ({"Host": "evil.example"}, 421),
                                ({"Origin": "http://evil.example", "Host": "evil.example"}, 421),
                                ({"Origin": f"http://127.0.0.1:{self.port}"}, 200)):
            with self.subTest(headers=headers):
                self.assertEqual(self.ask("GET", "/healthz", None, headers)[0], status)
        self.assertEqual(self.ask("OPTIONS", "/v1/jobs", None, {"Origin": "https://a.example"})[0],
                         403)

    def test_nobody_can_say_that_a_call_is_forwarded(self):
        status, _, _ = self.ask("GET", "/v1/capabilities", None, {
            "x-request-id": "forged", "tetstream-forwarded-proof": "0" * 64,
            "tetstream-forwarded-address": "ipv4:6.6.6.6:1"})
        self.assertEqual(status, 200)
        line = self.server.told("call", request_id="forged")[0]
        self.assertEqual(line["client"], "127.0.0.1")


class SlowCrowds(Guests):
    """Clients who begin requests and get nowhere, where nothing but another's need ends them."""

    options = ("--stall-seconds", "3600", "--max-http-connections", "64", "--receive-bytes", "16MiB")

    def trickle(self, connections):
        """Has each send a byte a few times a second until the test ends, or the server hangs up."""
        ended = threading.Event()

        def send():
            left = connections
            while left and not ended.wait(0.2):
                left = [connection for connection in left if self.goes_on(connection)]

        thread = threading.Thread(target=send)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(ended.set)

    @staticmethod
    def goes_on(connection):
        try:
            connection.sendall(b" ")
        except ConnectionError:
            return False
        return True

    def test_those_who_take_all_places_give_way(self):
        for _ in range(64):
            self.begin(1, 0)
        wait_until(lambda: self.answers(HEALTH) == 200)

    def test_those_who_take_all_places_and_trickle_give_way(self):
        self.trickle([self.begin(1 << 20, 0) for _ in range(64)])
        wait_until(lambda: self.answers(HEALTH) == 200)

    def test_those_who_were_refused_give_their_places_to_who_asks(self):
        for _ in range(64):
            refused = socket.create_connection((self.host, self.port), GENEROUS_END)
            self.addCleanup(refused.close)
            refused.sendall(b"nonsense\r\n\r\n")
            self.assertIn(b" 400 ", refused.recv(64))
        self.assertEqual(self.answers(HEALTH), 200)

    def check_that_the_room_is_given(self):
        for _ in range(10):
            self.assertEqual(self.answers(HEALTH), 200)
        # A question needs no room; a body is given it.
        wait_until(lambda: self.answers(POST % len(LARGE) + LARGE) == 400)

    def test_those_who_fill_the_room_keep_nobody_from_asking(self):
        size = 2 << 20
        for _ in range(ROOM // size):
            self.begin(size, size - 1)
        self.begin(size, 1000)
        self.check_that_the_room_is_given()

    def test_those_who_fill_the_room_and_trickle_keep_nobody_from_asking(self):
        size, rest = 2 << 20, 20_000
        self.trickle([self.begin(size, size - rest) for _ in range(ROOM // size)])
        self.check_that_the_room_is_given()

    def test_the_kernel_asks_whether_who_says_nothing_is_still_there(self):
        with socket.create_connection((self.host, self.port), GENEROUS_END) as idle:
            idle.sendall(HEALTH)
            self.assertTrue(idle.recv(64))
            ours = f"{self.port:04X}", f"{idle.getsockname()[1]:04X}"

            def timer():
                for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]:
                    words = line.split()
                    if (words[1].split(":")[1], words[2].split(":")[1]) == ours:
                        return int(words[5].split(":")[0], 16)
                return None

            wait_until(lambda: timer() == 2)  # the one of keepalive


class OtherOrigins(HttpTest):
    options = ("--http-origins", "https://farm.example, http://other.example:8080")

    def test_those_that_are_named_may_ask_and_read(self):
        status, headers, _ = self.ask("OPTIONS", "/v1/jobs", None, {"Origin": "https://farm.example"})
        self.assertEqual((status, headers["Access-Control-Allow-Origin"]),
                         (200, "https://farm.example"))
        status, headers, _ = self.ask("GET", "/v1/capabilities", None,
                                      {"Origin": "http://other.example:8080"})
        self.assertEqual((status, headers["Access-Control-Allow-Origin"]),
                         (200, "http://other.example:8080"))
        self.assertEqual(self.ask("GET", "/healthz", None, {"Origin": "http://farm.example"})[0], 403)


if __name__ == "__main__":
    unittest.main(verbosity=2)
