"""tetstreamd behind docker/haproxy.cfg: attacked over HTTP/2 while others use it, and with TLS.

    TETSTREAM_BIN=build/release/bin python3 tests/server/proxy_attack_test.py
"""

import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import tempfile
import threading
import unittest

from h2_attacks import ATTACKS, PREFACE, Attacker
from running_server import GENEROUS_END, RunningServer, binaries, unused_port, wait_until
from cutting_link import CuttingLink

CONFIGURATION = pathlib.Path(__file__).parents[2] / "docker" / "haproxy.cfg"
ATTACK_SECONDS = 1
FEW_FILES = 256  # file descriptors of tetstreamd; a flood would like to have more
FILES = 1024
STREAMS = FILES // 8  # what haproxy has ended takes a descriptor until tetstreamd sees that
MAX_RESIDENT_MB = 300


def resident_mb(process):
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def allow_files(server, count):
    resource.prlimit(server.process.pid, resource.RLIMIT_NOFILE, (count, count))


class WithoutAProxy(unittest.TestCase):
    def test_a_server_that_ran_out_of_files_ends_so_that_it_is_started_again(self):
        with tempfile.TemporaryDirectory() as scratch, RunningServer(f"{scratch}/store") as server:
            allow_files(server, FEW_FILES)

            def has_ended():
                ATTACKS["connection_flood"](Attacker(server.address, 1))
                return server.process.poll() is not None

            wait_until(has_ended)
            self.assertEqual(server.process.wait(GENEROUS_END), 3)
            self.assertEqual(len(server.log("stopped_listening")), 1)


class BehindAProxy(unittest.TestCase):
    client_options = ()

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.grid = cls.folder / "sphere.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.05", cls.grid], check=True)
        cls.server = cls.start_server()
        cls.start_proxy(cls.configuration())
        wait_until(lambda: cls.client("health").returncode == 0)

    @classmethod
    def start_server(cls):
        """With few file descriptors, of which nothing must run out."""
        server = RunningServer(cls.folder / "store")
        cls.addClassCleanup(server.kill)
        allow_files(server, FILES)
        return server

    @classmethod
    def configuration(cls):
        return CONFIGURATION

    @classmethod
    def start_proxy(cls, configuration):
        cls.address = f"127.0.0.1:{unused_port()}"
        host, port = cls.server.metrics.rsplit(":", 1)
        cls.proxy = subprocess.Popen(
            ["haproxy", "-f", configuration, "-db"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env={**os.environ, "TETSTREAM_PROXY_LISTEN": cls.address,
                 "TETSTREAM_PROXY_SERVER": cls.server.address,
                 "TETSTREAM_PROXY_HEALTH_HOST": host, "TETSTREAM_PROXY_HEALTH_PORT": port,
                 "TETSTREAM_PROXY_STREAMS": str(STREAMS), "TETSTREAM_PROXY_MAXCONN": "500"})

        def stop():
            cls.proxy.terminate()
            cls.proxy.wait(GENEROUS_END)

        cls.addClassCleanup(stop)

    @classmethod
    def client(cls, command, *arguments):
        return subprocess.run(
            [binaries() / "tetstream", command, *arguments, "--server", cls.address,
             *cls.client_options],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False)

    def mesh(self):
        return self.client("mesh", self.grid, "-o", self.folder / "mesh.vtu")


class ProxyAttack(BehindAProxy):
    def test_healthy_traffic_goes_on_during_every_attack(self):
        half_a_preface = self.connect_from("127.0.0.50")
        half_a_preface.send(PREFACE[:10])
        for number, (name, attack) in enumerate(ATTACKS.items()):
            with self.subTest(attack=name):
                attacker = Attacker(self.address, ATTACK_SECONDS, f"127.0.0.{100 + number}")
                thread = threading.Thread(target=attack, args=(attacker,))
                thread.start()
                while thread.is_alive():
                    result = self.mesh()
                    self.assertEqual(result.returncode, 0, result.stderr)
                thread.join()
                self.assertGreater(attacker.sent + attacker.connections, 0)
                self.assert_both_live()
        self.assertTrue(self.hangs_up(half_a_preface))

    def test_a_client_that_does_not_read_stops_only_itself(self):
        link = CuttingLink(self.address, holds_after=1 << 20)  # so that it cannot end before
        self.addCleanup(link.close)
        slow = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.grid, "-o", self.folder / "slow.vtu",
             "--spacing", "0.015", "--levels", "0", "--server", link.address],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(slow.wait)
        self.addCleanup(slow.kill)
        self.assertTrue(link.held.wait(GENEROUS_END))
        self.assertGreater(self.server.samples()["tetstream_meshes_running"], 0)
        slow.send_signal(signal.SIGSTOP)
        for _ in range(3):
            result = self.mesh()
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIsNone(slow.poll())

    def test_an_address_that_asks_too_often_is_turned_away_and_others_are_not(self):
        def is_turned_away():
            ATTACKS["rapid_reset"](Attacker(self.address, 2, "127.0.0.60"))
            return self.turns_away("127.0.0.60")

        self.assertFalse(self.turns_away("127.0.0.60"))
        wait_until(is_turned_away)
        self.assertEqual(self.mesh().returncode, 0)

    def connect_from(self, source):
        host, port = self.address.rsplit(":", 1)
        connection = socket.create_connection((host, int(port)), GENEROUS_END, (source, 0))
        self.addCleanup(connection.close)
        return connection

    def turns_away(self, source):
        """Whether a connection is refused, or ended before the proxy says anything."""
        try:
            connection = self.connect_from(source)
            connection.send(PREFACE)
            return self.hangs_up(connection)
        except ConnectionError:
            return True

    @staticmethod
    def hangs_up(connection):
        connection.settimeout(GENEROUS_END)
        try:
            return connection.recv(1) == b""
        except ConnectionError:
            return True

    def assert_both_live(self):
        for process in (self.server.process, self.proxy):
            self.assertIsNone(process.poll())
            self.assertLess(resident_mb(process), MAX_RESIDENT_MB)


class ProxyWithTls(BehindAProxy):
    """The line of docker/haproxy.cfg that is there for TLS, in place of the one without."""

    @classmethod
    def configuration(cls):
        certificate = cls.folder / "server.pem"
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
             "-nodes", "-subj", "/CN=proxy", "-addext", "subjectAltName=IP:127.0.0.1",
             "-keyout", cls.folder / "server.key", "-out", certificate],
            check=True, capture_output=True)
        cls.client_options = ("--tls-ca", certificate)
        both = cls.folder / "both.pem"
        both.write_text(certificate.read_text() + (cls.folder / "server.key").read_text())
        text = CONFIGURATION.read_text()
        example = re.search(r"# TLS: bind :7447 (ssl crt )/etc/haproxy/server.pem( alpn h2)", text)
        bind = f'  bind "${{TETSTREAM_PROXY_LISTEN}}" {example[1]}{both}{example[2]}'
        secured, count = re.subn("^  bind .*$", bind, text, flags=re.MULTILINE)
        assert count == 1, text
        configuration = cls.folder / "haproxy.cfg"
        configuration.write_text(secured)
        return configuration

    def test_meshes_the_same_bytes_as_without_a_proxy(self):
        result = self.mesh()
        self.assertEqual(result.returncode, 0, result.stderr)
        direct = self.folder / "direct.vtu"
        subprocess.run([binaries() / "tetstream", "mesh", self.grid, "-o", direct, "--server",
                        self.server.address], check=True, capture_output=True)
        self.assertEqual((self.folder / "mesh.vtu").read_bytes(), direct.read_bytes())

    def test_turns_away_who_does_not_speak_tls_or_does_not_trust_it(self):
        for options, words in (((), "--tls"), (("--tls",), "--tls-ca")):
            with self.subTest(options=options):
                result = subprocess.run(
                    [binaries() / "tetstream", "health", "--server", self.address, *options],
                    capture_output=True, text=True, timeout=GENEROUS_END, check=False)
                self.assertNotEqual(result.returncode, 0)
                self.assertIn(words, result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
