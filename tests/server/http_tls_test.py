"""The HTTP port of a real server with TLS and tokens.

    TETSTREAM_BIN=build/release/bin python3 tests/server/http_tls_test.py [unittest options]
"""

import http.client
import ssl
import subprocess
import time
import unittest

from http_case import HttpTest
from running_server import GENEROUS_END, binaries, wait_until


class TokensAndTls(HttpTest):
    """The rules of gRPC's port, with the same files."""

    options = ("--tls-cert", "server.pem", "--tls-key", "server.key", "--tokens", "tokens.toml")

    @classmethod
    def prepare(cls):
        subprocess.run(
            "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=ours "
            "-addext subjectAltName=IP:127.0.0.1 -keyout server.key -out server.pem".split(),
            cwd=cls.folder, check=True, capture_output=True)
        made = subprocess.run([binaries() / "tetstreamd", "--new-token", "alice"],
                              capture_output=True, text=True, check=True)
        cls.token = made.stderr.splitlines()[-1]
        (cls.folder / "tokens.toml").write_text(made.stdout)
        (cls.folder / "tokens.toml").chmod(0o600)
        cls.options = tuple(str(cls.folder / option) if "." in option else option
                            for option in cls.options)

    def connection(self):
        context = ssl.create_default_context(cafile=self.folder / "server.pem")
        connection = http.client.HTTPSConnection(self.host, self.port, timeout=GENEROUS_END,
                                                 context=context)
        self.addCleanup(connection.close)
        return connection

    def bearer(self, token=None):
        return {"Authorization": f"Bearer {token or self.token}"}

    def test_what_comes_without_a_token_is_not_looked_at(self):
        wrong = b'{"mesh": [' + b"{}," * 1000
        kind = {"Content-Type": "application/json"}
        status, _, body = self.ask("POST", "/v1/jobs", wrong, kind)
        self.assertEqual(status, 401)
        self.assertIn(b"TOKEN_MISSING", body)
        self.assertEqual(self.ask("POST", "/v1/jobs", wrong, {**kind, **self.bearer()})[0], 400)

    def test_a_token_is_asked_for(self):
        status, said = self.json("GET", "/v1/grids")
        self.assertEqual((status, said["error"]["reason"]), (401, "TOKEN_MISSING"))
        status, said = self.json("GET", "/v1/grids", headers=self.bearer("wrong"))
        self.assertEqual((status, said["error"]["reason"]), (401, "TOKEN_UNKNOWN"))
        self.assertEqual(self.json("GET", "/v1/grids", headers=self.bearer())[0], 200)
        self.assertEqual(self.ask("GET", "/metrics")[0], 401)
        self.assertEqual(self.ask("GET", "/metrics/history")[0], 401)
        self.assertEqual(self.ask("GET", "/metrics/history", None, self.bearer())[0], 200)
        status, _, body = self.ask("GET", "/metrics", None, self.bearer())
        self.assertEqual(status, 200)
        self.assertIn(b"tetstream_http_connections", body)

    def test_says_that_grpc_has_tls(self):
        port = int(self.server.address.rsplit(":", 1)[1])
        self.assertEqual(self.json("GET", "/v1/grpc.json"),
                         (200, {"host": "127.0.0.1", "port": port, "tls": True}))

    def test_a_file_and_its_mesh_go_over_tls(self):
        self.assertEqual(self.put(self.bytes, self.bearer())[0], 200)
        messages, trailers = self.call("MeshService/StreamMesh", self.mesh_request(), self.bearer())
        self.assertEqual(trailers["grpc-status"], "0")
        self.assertEqual(messages[-1][0], 4 << 3 | 2)
        line = self.server.told("call", method="StreamMesh")[0]
        self.assertEqual(line["client"], "alice")

    def test_plain_http_and_broken_handshakes_end(self):
        for data in (b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\x16\x03\x01\xff\xff" + b"a" * 999):
            try:
                self.assertNotIn(b"HTTP", self.raw(data))
            except ConnectionResetError:
                pass  # without an answer, too
        self.assertEqual(self.json("GET", "/v1/grids", headers=self.bearer())[0], 200)

    def test_what_is_kept_old_and_when_the_certificate_ends_are_told(self):
        def told(what):
            return self.server.samples()[f'tetstream_kept_old{{what="{what}"}}']
        end = self.server.samples()["tetstream_certificate_expires_seconds"]
        self.assertTrue(29 * 86400 < end - time.time() < 31 * 86400)
        self.assertEqual((told("tokens"), told("certificate")), (0, 0))
        for what, file in (("tokens", "tokens.toml"), ("certificate", "server.pem")):
            good = self.folder / file
            away = good.rename(self.folder / "away")
            wait_until(lambda kept=what: told(kept) == 1)
            away.rename(good)
            wait_until(lambda kept=what: told(kept) == 0)

    def test_a_replaced_certificate_is_taken(self):
        before = ssl.get_server_certificate((self.host, self.port))
        for old in ("server.key", "server.pem"):
            (self.folder / old).unlink()
        subprocess.run(
            "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=ours "
            "-addext subjectAltName=IP:127.0.0.1 -keyout server.key -out server.pem".split(),
            cwd=self.folder, check=True, capture_output=True)
        wait_until(lambda: ssl.get_server_certificate((self.host, self.port)) != before)


if __name__ == "__main__":
    unittest.main(verbosity=2)
