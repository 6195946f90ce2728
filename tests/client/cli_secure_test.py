"""The tetstream command with servers that speak TLS and want to know who calls.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_secure_test.py [unittest options]
"""

import os
import socket
import ssl
import subprocess
import unittest
import warnings

from command_case import (
    DONE, GENEROUS_END, REFUSED, SERVER, CommandTest, binaries, unused_port, wait_until)

NEW_KEY = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes"


class Secure(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name in ("ours", "theirs"):
            cls.openssl(f"req -x509 {NEW_KEY} -subj /CN={name} -keyout {name}.key -out {name}.pem")
        cls.sign("server", "ours")
        cls.sign("client", "ours")
        cls.write_token("alice")
        tls = ("--tls-cert", "server.pem", "--tls-key", "server.key")
        cls.plain = cls.serve("plain")
        cls.with_tokens = cls.serve("with-tokens", *tls, "--tokens", "tokens.toml")
        cls.with_clients = cls.serve("with-clients", *tls, "--tls-client-ca", "ours.pem")

    @classmethod
    def openssl(cls, arguments):
        subprocess.run(["openssl", *arguments.split()], cwd=cls.inputs, check=True,
                       capture_output=True)

    @classmethod
    def sign(cls, name, authority):
        cls.openssl(f"req {NEW_KEY} -subj /CN={name} -keyout {name}.key -out {name}.csr "
                    "-addext subjectAltName=IP:127.0.0.1")
        cls.openssl(f"x509 -req -in {name}.csr -copy_extensions copy -days 1 -CA {authority}.pem "
                    f"-CAkey {authority}.key -out {name}.pem")

    @classmethod
    def write_token(cls, name):
        """As an operator does: the token to its owner, its entry to the server's file."""
        made = subprocess.run([binaries() / "tetstreamd", "--new-token", name],
                              capture_output=True, text=True, check=True)
        (cls.inputs / "token").write_text(made.stderr.splitlines()[-1] + "\n")
        (cls.inputs / "tokens.toml").write_text(made.stdout)
        (cls.inputs / "tokens.toml").chmod(0o600)

    @classmethod
    def serve(cls, name, *options):
        address = f"127.0.0.1:{unused_port()}"
        server = subprocess.Popen(
            [binaries() / "tetstreamd", "--listen", address, "--store", name,
             "--lame-duck-seconds", "0", "--port-file", f"{name}.port", *options],
            cwd=cls.inputs, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def stop():
            server.terminate()
            server.wait(GENEROUS_END)

        cls.addClassCleanup(stop)
        wait_until((cls.inputs / f"{name}.port").exists)
        return address

    def ask(self, address, *options, **more):
        return self.tetstream("mesh", "sphere.vdb", "-o", self.out / "mesh.vtu",
                              "--server", address, *options, cwd=self.inputs, **more)

    def health(self, address, *options):
        return self.tetstream("health", "--server", address, *options, cwd=self.inputs)

    def test_meshes_where_its_credentials_are_good(self):
        trusting = ("--tls-ca", "ours.pem")
        self.assert_done(self.ask(self.with_tokens, *trusting, "--token-file", "token"))
        self.assert_done(self.ask(self.with_clients, *trusting, "--tls-cert", "client.pem",
                                  "--tls-key", "client.key"))
        environment = {**os.environ, "TETSTREAM_TOKEN_FILE": "token"}
        self.assert_done(self.ask(self.with_tokens, *trusting, env=environment))

    def test_asks_for_health_without_a_token(self):
        result = self.health(self.with_tokens, "--tls-ca", "ours.pem")
        self.assertEqual(result.returncode, DONE, result.stderr)

    def test_no_tls_older_than_1_2_is_spoken(self):
        self.assertIsNone(self.tls_version(ssl.TLSVersion.TLSv1_1))
        for newest, spoken in ((ssl.TLSVersion.TLSv1_2, "TLSv1.2"), (ssl.TLSVersion.TLSv1_3, "TLSv1.3")):
            # The server leaves whoever takes ten seconds for the handshake, as a busy machine may.
            self.assertEqual(wait_until(lambda: self.tls_version(newest)), spoken)  # noqa: B023

    def tls_version(self, newest):
        """What a client that may speak anything up to `newest` agrees on; None where nothing."""
        context = ssl.create_default_context(cafile=self.inputs / "ours.pem")
        context.set_alpn_protocols(["h2"])
        context.set_ciphers("ALL:@SECLEVEL=0")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            context.minimum_version, context.maximum_version = ssl.TLSVersion.TLSv1, newest
        host, port = self.with_tokens.rsplit(":", 1)
        with socket.create_connection((host, int(port)), GENEROUS_END) as connection:
            try:
                with context.wrap_socket(connection, server_hostname=host) as secure:
                    return secure.version()
            except (ssl.SSLError, ConnectionError):
                return None

    def test_says_what_to_do_where_there_is_no_common_language(self):
        for address, options, words in (
                (self.with_tokens, (), "--tls"),
                (self.plain, ("--tls-ca", "ours.pem"), "does not speak TLS"),
                (self.with_tokens, ("--tls",), "--tls-ca"),
                (self.with_tokens, ("--tls-ca", "theirs.pem"), "--tls-ca"),
                (self.with_clients, ("--tls-ca", "ours.pem"), "--tls-cert")):
            with self.subTest(options=options, words=words):
                self.assert_fails(self.health(address, *options), SERVER, address, words)

    def test_refused_credentials_are_no_failure_of_the_server(self):
        trusting = ("--tls-ca", "ours.pem")
        self.assert_fails(self.ask(self.with_tokens, *trusting), REFUSED, "--token-file")
        (self.inputs / "other-token").write_text("tetstream_of_nobody\n")
        result = self.ask(self.with_tokens, *trusting, "--token-file", "other-token")
        self.assert_fails(result, REFUSED, "the token is not known")
        self.assertNotIn("tetstream_of_nobody", result.stderr)

    def test_keeps_a_token_from_where_it_could_be_read(self):
        token = ("--token-file", "token")
        self.assert_fails(self.ask("mesher.example:7447", *token), REFUSED, "unencrypted", "--tls")
        self.assert_done(self.ask(self.plain, *token))

    def test_refuses_files_that_are_not_what_they_should_be(self):
        for options, words in ((("--token-file", "nowhere"), "nowhere"),
                               (("--token-file", "tokens.toml"), "one line"),
                               (("--tls-ca", "nowhere"), "nowhere"),
                               (("--tls-ca", "token"), "CERTIFICATE"),
                               (("--tls-cert", "client.pem"), "go together")):
            with self.subTest(options=options):
                self.assert_fails(self.ask(self.plain, *options), REFUSED, words)


if __name__ == "__main__":
    unittest.main(verbosity=2)
