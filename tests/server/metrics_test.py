"""What an operator sees of a running server: metrics as Prometheus reads them, and the access log.

    TETSTREAM_BIN=build/dev/bin python3 tests/server/metrics_test.py [unittest options]
"""

import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import unittest
import urllib.parse
import urllib.request

from running_server import (
    GENEROUS_END, RunningServer, binaries, fetch, unused_port, wait_until)
from cutting_link import CuttingLink


class ServerTest(unittest.TestCase):
    """A server that has made one mesh and refused another."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.ball = cls.folder / "ball.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.05", cls.ball], check=True)
        cls.server = cls.enterClassContext(RunningServer(cls.folder / "store"))
        cls.made = cls.mesh()
        cls.refused = cls.mesh("--grid", "none")

    @classmethod
    def mesh(cls, *options, **environment):
        """A client's mesh, once the server has told of it, too."""
        told = len(cls.calls("StreamMesh"))
        made = cls.server.tetstream(
            "mesh", cls.ball, "-o", cls.folder / "m.vtu", *options,
            env={**os.environ, **environment})
        wait_until(lambda: len(cls.calls("StreamMesh")) > told)
        return made

    @classmethod
    def calls(cls, method):
        return [line for line in cls.server.log("call") if line["method"] == method]


class Metrics(ServerTest):
    def test_promtool_finds_nothing_to_object_to(self):
        _, text = fetch(self.server.metrics, "/metrics")
        checked = subprocess.run(
            ["promtool", "check", "metrics"], input=text, capture_output=True, text=True,
            timeout=GENEROUS_END, check=False)
        self.assertEqual((checked.returncode, checked.stdout + checked.stderr), (0, ""))

    def test_counts_calls_refusals_and_what_was_sent(self):
        self.assertEqual(self.made.returncode, 0, self.made.stderr)
        wait_until(lambda: self.server.samples()["tetstream_meshes_running"] == 0)
        samples = self.server.samples()
        self.assertEqual(samples['tetstream_calls_total{code="OK",method="StreamMesh"}'], 1)
        self.assertEqual(
            samples['tetstream_refusals_total{code="NOT_FOUND",reason="GRID_NOT_IN_FILE"}'], 1)
        sent = self.calls("StreamMesh")[0]
        self.assertEqual(samples["tetstream_sent_tets_total"], sent["tets"])
        self.assertEqual(samples["tetstream_sent_bytes_total"], sent["bytes_out"])
        self.assertEqual(samples["tetstream_sent_chunks_total"], sent["chunks"])
        size = self.ball.stat().st_size
        for name in ("tetstream_upload_bytes_total", "tetstream_store_bytes"):
            self.assertEqual(samples[name], size)
        self.assertEqual(samples["tetstream_first_chunk_seconds_count"], 1)
        self.assertEqual(samples["tetstream_meshes_running"], 0)
        self.assertGreater(samples["tetstream_resident_bytes"], 0)
        self.assertGreater(samples["process_resident_memory_bytes"], 1 << 20)
        self.assertGreater(samples["process_start_time_seconds"], 1.7e9)

    def test_a_hundred_idle_connections_hold_up_neither_health_nor_service(self):
        host, port = self.server.metrics.rsplit(":", 1)
        idle = [socket.socket() for _ in range(100)]
        try:
            for connection in idle:
                connection.setblocking(False)  # those that the kernel does not take yet wait there
                connection.connect_ex((host, int(port)))
            wait_until(lambda: self.server.tetstream("health").returncode == 0)
        finally:
            for connection in idle:
                connection.close()
        self.assertEqual(fetch(self.server.metrics, "/healthz"), (200, "ok\n"))

    def test_knows_no_other_pages(self):
        self.assertEqual(fetch(self.server.metrics, "/")[0], 404)
        self.assertEqual(fetch(self.server.metrics, "/metrics/../../etc/passwd")[0], 404)


class Clients(unittest.TestCase):
    """A server that asks for tokens."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        made = subprocess.run([binaries() / "tetstreamd", "--new-token", "alice"], check=True,
                              capture_output=True, text=True, timeout=GENEROUS_END)
        for name, text in (("tokens.toml", made.stdout),
                           ("token", re.search(r"tetstream_[\w-]+", made.stderr)[0] + "\n")):
            (self.folder / name).touch(mode=0o600)
            (self.folder / name).write_text(text)
        self.server = self.enterContext(RunningServer(
            self.folder / "store", "--tokens", self.folder / "tokens.toml", "--http-listen", "127.0.0.1:0"))

    def used(self, what, client):
        return self.server.samples()[f'tetstream_client_{what}_total{{client="{client}"}}']

    def test_are_told_by_their_names_to_operators_alone(self):
        ball = self.folder / "ball.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.05", ball], check=True)
        made = self.server.tetstream("mesh", ball, "-o", self.folder / "m.vtu",
                                     "--token-file", self.folder / "token")
        self.assertEqual(made.returncode, 0, made.stderr)
        sent = wait_until(lambda: next(
            (line for line in self.server.log("call") if line["method"] == "StreamMesh"), None))
        self.assertEqual(self.used("sent_bytes", "alice"), sent["bytes_out"])
        self.assertEqual(self.used("received_bytes", "alice"), ball.stat().st_size)
        wait_until(lambda: self.used("calls", "alice") == len(self.server.log("call")))
        self.assertGreater(self.used("work_seconds", "alice"), 0)
        self.assertEqual(self.used("calls", "(others)"), 0)
        request = urllib.request.Request(
            f"http://{self.server.ready['http']}/metrics",
            headers={"Authorization": "Bearer " + (self.folder / "token").read_text().strip()})
        with urllib.request.urlopen(request, timeout=GENEROUS_END) as answer:
            told = answer.read().decode()
        self.assertIn("tetstream_calls_total", told)
        self.assertNotIn("tetstream_client_", told)

    def test_without_a_good_token_are_told_together(self):
        (self.folder / "token").write_text("tetstream_" + "x" * 43 + "\n")
        refused = self.server.tetstream("job", "list", "--token-file", self.folder / "token")
        self.assertNotEqual(refused.returncode, 0)
        wait_until(lambda: self.used("refusals", "(others)") > 0)
        told = {name for name in self.server.samples() if name.startswith("tetstream_client_calls")}
        self.assertEqual(told, {'tetstream_client_calls_total{client="(others)"}'})


class Dashboard(ServerTest):
    """Grafana's dashboard, and what it asks Prometheus for."""

    docker = pathlib.Path(__file__).resolve().parents[2] / "docker"

    def test_asks_only_for_metrics_that_there_are(self):
        dashboard = json.loads((self.docker / "grafana" / "tetstream.json").read_text())
        queries = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
        asked = {name for query in queries
                 for name in re.findall(r"\b(?:tetstream|process)_\w+", query)}
        there = {name.split("{")[0] for name in self.server.samples()}
        self.assertGreater(len(asked), 25)
        with_tls = {"tetstream_certificate_expires_seconds"}
        self.assertEqual(asked - there - with_tls, set())

    def test_and_the_manual_know_all_of_them(self):
        manual = (self.docker.parent / "docs" / "operations.md").read_text()
        there = {re.sub("_(bucket|sum|count)$", "", name.split("{")[0])
                 for name in self.server.samples() if name.startswith("tetstream_")}
        self.assertEqual({name for name in there if f"`{name}`" not in manual}, set())

    def test_prometheus_takes_its_configuration(self):
        checked = subprocess.run(
            ["promtool", "check", "config", self.docker / "prometheus.yml"],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


class InPrometheus(ServerTest):
    def test_a_real_prometheus_scrapes_and_answers(self):
        config = self.folder / "prometheus.yml"
        config.write_text(
            "scrape_configs:\n- job_name: tetstream\n  scrape_interval: 1s\n"
            f"  scrape_timeout: 1s\n  static_configs: [{{targets: ['{self.server.metrics}']}}]\n")
        address = f"127.0.0.1:{unused_port()}"
        prometheus = subprocess.Popen(
            ["prometheus", f"--config.file={config}", f"--web.listen-address={address}",
             f"--storage.tsdb.path={self.folder / 'tsdb'}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(prometheus.wait, GENEROUS_END)
        self.addCleanup(prometheus.kill)

        def query():
            asked = urllib.parse.quote(
                'sum(tetstream_calls_total{job="tetstream",method="StreamMesh"})')
            try:
                with urllib.request.urlopen(
                        f"http://{address}/api/v1/query?query={asked}", timeout=GENEROUS_END) as response:
                    return json.load(response)["data"]["result"]
            except OSError:
                return []

        self.assertEqual(wait_until(query)[0]["value"][1], "2")


class AccessLog(ServerTest):
    def test_tells_what_a_stream_did(self):
        line = self.calls("StreamMesh")[0]
        self.assertEqual((line["status"], line["client"]), ("OK", "127.0.0.1"))
        self.assertRegex(line["grid"], "^[0-9a-f]{64}$")
        self.assertRegex(line["mesh_id"], "^[0-9a-f]{64}$")
        self.assertIn("grpc-c++", line["user_agent"])
        self.assertGreater(line["tets"], 0)
        self.assertLessEqual(line["plan_ms"], line["first_chunk_ms"])
        self.assertLessEqual(line["first_chunk_ms"], line["duration_ms"])
        upload = self.server.told("call", method="UploadGrid")[0]
        self.assertEqual(upload["bytes_in"], self.ball.stat().st_size)

    def test_the_command_line_names_the_line_to_look_for(self):
        self.assertEqual(self.refused.returncode, 1)
        request_id = re.search(r"\(request ([0-9a-f]+)\)", self.refused.stderr)[1]
        line = next(line for line in self.calls("StreamMesh") if line["request_id"] == request_id)
        self.assertEqual((line["status"], line["reason"]), ("NOT_FOUND", "GRID_NOT_IN_FILE"))

    def test_passes_a_trace_through(self):
        trace, parent = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"
        self.mesh(TRACEPARENT=f"00-{trace}-{parent}-01")
        line = self.calls("StreamMesh")[-1]
        self.assertEqual((line["trace_id"], line["parent_id"]), (trace, parent))
        self.assertRegex(line["span_id"], "^[0-9a-f]{16}$")

    def test_ignores_a_malformed_trace(self):
        self.mesh(TRACEPARENT="00-0af7651916cd43dd8448eb211c80319c-0000000000000000-01")
        self.assertNotIn("trace_id", self.calls("StreamMesh")[-1])


class Draining(ServerTest):
    def test_goes_on_for_a_while_when_it_has_said_so(self):
        server = self.enterContext(
            RunningServer(self.folder / "lame", "--lame-duck-seconds", "3600"))
        wait_until(lambda: server.tetstream("health").returncode == 0)
        server.process.send_signal(signal.SIGTERM)
        wait_until(lambda: server.log("lame_duck"))
        for stop in (signal.SIGSTOP, signal.SIGCONT):  # as a debugger does: that is no second signal
            server.process.send_signal(stop)
        self.assertNotEqual(server.tetstream("health").returncode, 0)
        self.assertEqual(server.tetstream("health", "--service", "liveness").returncode, 0)
        self.assertEqual(fetch(server.metrics, "/readyz"), (503, "not ready\n"))
        done = server.tetstream("job", "list")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(server.terminate(), 3)  # told once more, it ends at once

    def test_says_so_before_it_goes_and_goes_on_answering(self):
        wait_until(lambda: fetch(self.server.metrics, "/readyz") == (200, "ok\n"))
        link = CuttingLink(self.server.address, holds_after=1 << 20)  # so that it cannot end before
        self.addCleanup(link.close)
        with subprocess.Popen(
                [binaries() / "tetstream", "mesh", self.ball, "-o", self.folder / "long.vtu",
                 "--spacing", "0.015", "--levels", "0", "--server", link.address],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as stream:
            self.assertTrue(link.held.wait(GENEROUS_END))
            wait_until(lambda: self.server.samples()["tetstream_meshes_running"] == 1)
            self.server.process.send_signal(signal.SIGTERM)
            wait_until(lambda: self.server.log("draining"))
            self.assertEqual(fetch(self.server.metrics, "/readyz"), (503, "not ready\n"))
            self.assertEqual(fetch(self.server.metrics, "/healthz"), (200, "ok\n"))
            self.assertEqual(self.server.samples()["tetstream_ready"], 0)
            stream.kill()
        self.assertEqual(self.server.process.wait(GENEROUS_END), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
