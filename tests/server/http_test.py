"""The HTTP port of a real server: gRPC-Web, JSON, uploads, and its end.

    TETSTREAM_BIN=build/release/bin python3 tests/server/http_test.py [unittest options]
"""

import base64
import hashlib
import json
import pathlib
import re
import socket
import struct
import subprocess
import unittest

from http_case import GRPC_WEB, HttpTest, MESH_NAME, ROOT, field, framed, frames
from running_server import GENEROUS_END, binaries, wait_until


class GrpcWeb(HttpTest):
    def setUp(self):
        self.assertEqual(self.put(self.bytes)[0], 200)

    def test_a_mesh_comes_as_it_does_over_grpc(self):
        messages, trailers = self.call("MeshService/StreamMesh", self.mesh_request())
        self.assertEqual(trailers["grpc-status"], "0", trailers)
        self.assertRegex(trailers["x-request-id"], "^[0-9a-f]{16}$")
        chunks = [m for m in messages if m[0] == 3 << 3 | 2]
        self.assertGreaterEqual(len(chunks), 1)
        self.assertEqual(messages[-1][0], 4 << 3 | 2)  # the trailer
        line = self.server.told("call", request_id=trailers["x-request-id"])[0]
        self.assertEqual(line["client"], "127.0.0.1")
        self.assertRegex(line["peer"], r"^ipv4:127\.0\.0\.1:\d+$")
        self.assertEqual(line["status"], "OK")

    def test_a_refusal_has_the_details_that_grpc_has(self):
        request = field(MESH_NAME, field(1, b"grids/" + b"0" * 64))
        messages, trailers = self.call("MeshService/StreamMesh", request)
        self.assertEqual((messages, trailers["grpc-status"]), ([], "5"))
        self.assertIn("grpc-message", trailers)
        self.assertIn(b"GRID_NOT_FOUND", base64.b64decode(trailers["grpc-status-details-bin"]))

    def test_the_callers_request_id_and_agent_reach_the_log(self):
        self.call("MeshService/GetCapabilities", b"",
                  {"x-request-id": "from-a-tab", "User-Agent": "a browser"})
        line = self.server.told("call", request_id="from-a-tab")[0]
        self.assertEqual(line["user_agent"], "a browser")

    def test_a_deadline_is_kept(self):
        request = field(MESH_NAME, field(1, f"grids/{self.digest}".encode()) +
                        b"\x19" + struct.pack("<d", 0.004))  # spacing: seconds of work
        _, trailers = self.call("MeshService/StreamMesh", request, {"grpc-timeout": "20m"})
        self.assertEqual(trailers["grpc-status"], "4", trailers)

    def test_a_tab_that_closes_ends_its_call(self):
        request = field(MESH_NAME, field(1, f"grids/{self.digest}".encode()) +
                        b"\x19" + struct.pack("<d", 0.003))
        wait_until(lambda: self.samples()["tetstream_meshes_running"] == 0)  # of the test before
        connection = self.connection()
        connection.request("POST", "/tetstream.v1.MeshService/StreamMesh", framed(request),
                           {**GRPC_WEB, "x-request-id": "closing-tab"})
        wait_until(lambda: self.samples()["tetstream_meshes_running"] == 1)
        connection.close()
        wait_until(lambda: [line for line in self.server.log("call")
                            if line["request_id"] == "closing-tab"
                            and line["status"] == "CANCELLED"])
        wait_until(lambda: self.samples()["tetstream_meshes_running"] == 0)

    def test_a_tab_that_stops_reading_holds_up_its_own_stream_only(self):
        request = field(MESH_NAME, field(1, f"grids/{self.digest}".encode()) +
                        b"\x19" + struct.pack("<d", 0.008) + b"\x28\x00")
        stuck = self.connection()
        stuck.request("POST", "/tetstream.v1.MeshService/StreamMesh", framed(request), GRPC_WEB)
        answer = stuck.getresponse()
        self.assertTrue(answer.read(5))  # it has begun, and is read no further
        messages, trailers = self.call("MeshService/StreamMesh", self.mesh_request())
        self.assertEqual(trailers["grpc-status"], "0")
        self.assertTrue(messages)

    def test_no_frame_but_one_message_is_taken(self):
        for body in (b"", b"\0", b"\0\0\0\0\5abc", b"\0\0\0\0\0\0\0\0\0\0", b"\x80\0\0\0\0"):
            with self.subTest(body=body):
                status, _, answer = self.ask(
                    "POST", "/tetstream.v1.MeshService/GetCapabilities", body, GRPC_WEB)
                self.assertEqual((status, frames(answer)[1]["grpc-status"]), (200, "3"))
        status, _, answer = self.ask("POST", "/tetstream.v1.MeshService/GetCapabilities",
                                     b"\1\0\0\0\0", GRPC_WEB)
        self.assertEqual(frames(answer)[1]["grpc-status"], "12")

    def test_what_a_browser_cannot_send_is_refused(self):
        for method in ("GridService/UploadGrid", "MeshService/RemeshSession",
                       "MeshService/SamplePoints"):
            self.assertEqual(self.ask("POST", f"/tetstream.v1.{method}", framed(b""), GRPC_WEB)[0],
                             501)
        self.assertEqual(self.ask("POST", "/tetstream.v1.MeshService/No", framed(b""), GRPC_WEB)[0],
                         404)
        self.assertEqual(self.ask("POST", "/grpc.health.v1.Health/Check", framed(b""), GRPC_WEB)[0],
                         404)


class Json(HttpTest):
    def test_a_jobs_life(self):
        self.put(self.bytes)
        status, job = self.json("POST", "/v1/jobs", {
            "job": {"mesh": {"name": f"grids/{self.digest}"}, "labels": {"night": "1"}},
            "requestId": "one"})
        self.assertEqual(status, 200, job)
        status, done = self.json("GET", f"/v1/{job['name']}:wait?timeout={GENEROUS_END:.0f}s")
        self.assertEqual((status, done["state"]), (200, "JOB_STATE_SUCCEEDED"), done)
        listed = self.json("GET", "/v1/jobs?pageSize=5")[1]["jobs"]
        self.assertEqual([j["name"] for j in listed], [job["name"]])
        filtered = self.json("POST", "/v1/jobs:list", {"filter": {"labels": {"night": "2"}}})[1]
        self.assertNotIn("jobs", filtered)
        self.assertEqual(self.json("DELETE", f"/v1/{job['name']}")[0], 200)
        status, refused = self.json("GET", f"/v1/{job['name']}")
        self.assertEqual((status, refused["error"]["reason"]), (404, "JOB_NOT_FOUND"))

    def test_grids_and_estimates(self):
        self.put(self.bytes)
        name = f"grids/{self.digest}"
        info = self.json("GET", f"/v1/{name}")[1]
        self.assertEqual(info["grids"][0]["valueType"], "float")
        estimate = self.json("POST", "/v1/meshes:estimate",
                             {"mesh": {"name": name, "spacing": 0.1}})
        self.assertEqual(estimate[0], 200, estimate)
        self.assertGreater(int(estimate[1]["tetCount"]), 0)

    def test_the_last_hours_metrics(self):
        status, history = self.json("GET", "/metrics/history")
        self.assertEqual(status, 200)
        ages = history["seconds_ago"]
        self.assertEqual(ages, sorted(ages, reverse=True))
        self.assertGreaterEqual(len(ages), 1)
        self.assertGreaterEqual(min(ages), 0)
        for series, values in history["samples"].items():
            self.assertEqual(len(values), len(ages), series)
        now = self.samples()
        kept = {s for s in now if "_bucket" not in s and s in history["samples"]}
        self.assertIn("tetstream_sent_tets_total", kept)
        self.assertIn("process_resident_memory_bytes", kept)
        some = self.json("GET", "/metrics/history?names=tetstream_evictions_total,no_such")[1]
        self.assertEqual({s.split("{")[0] for s in some["samples"]}, {"tetstream_evictions_total"})
        encoded = self.json("GET", "/metrics/history?names=tetstream_evictions_total%2Cno_such")[1]
        self.assertEqual(encoded["samples"].keys(), some["samples"].keys())
        for query in ("name=x", "names", "names=%0a", "x&names=y"):
            status, refused = self.json("GET", f"/metrics/history?{query}")
            self.assertEqual((status, refused["error"]["code"] > 0), (400, True), query)

    def test_says_what_is_wrong_with_json(self):
        for body, status in (("{", 400), ('{"no": 1}', 400), ("[]", 400),
                             ("[" * 100 + "]" * 100, 400)):
            got = self.ask("POST", "/v1/jobs", body, {"Content-Type": "application/json"})
            self.assertEqual(got[0], status)
            self.assertTrue(json.loads(got[2])["error"]["message"])
        self.assertEqual(self.ask("POST", "/v1/jobs", "{}", {"Content-Type": "text/plain"})[0], 415)
        self.assertEqual(self.ask("DELETE", "/v1/jobs")[0], 405)
        self.assertEqual(self.ask("GET", "/v1/nothing")[0], 404)
        self.assertEqual(self.ask("GET", "/v1/jobs?pageSize=1&pageSize=2")[0], 400)

    def test_openapi_knows_every_unary_method_and_field(self):
        document = self.json("GET", "/v1/openapi.json")[1]
        methods = {operation["x-grpc-method"] for path in document["paths"].values()
                   for operation in path.values()}
        protos = pathlib.Path(__file__).resolve().parents[2] / "proto" / "tetstream" / "v1"
        unary = set()
        for proto in ("grids", "meshes", "jobs"):
            text = (protos / f"{proto}.proto").read_text()
            service = text.split("service ")[1].split(" ")[0]
            for line in text.splitlines():
                words = line.split("rpc ")
                if len(words) == 2 and not line.lstrip().startswith("//") and "stream " not in line:
                    unary.add(f"tetstream.v1.{service}.{words[1].split('(')[0]}")
        self.assertEqual(methods - {"tetstream.v1.GridService.UploadGrid"}, unary)
        schemas = document["components"]["schemas"]
        self.assertIn("nextPageToken", schemas["tetstream.v1.ListJobsResponse"]["properties"])
        references = [text.split('"')[0]
                      for text in json.dumps(document).split("#/components/schemas/")[1:]]
        self.assertEqual({r for r in references if r not in schemas}, set())


    def test_says_where_grpc_is(self):
        host, port = self.server.address.rsplit(":", 1)
        self.assertEqual(self.json("GET", "/v1/grpc.json"),
                         (200, {"host": host, "port": int(port), "tls": False}))
        self.assertEqual(self.ask("POST", "/v1/grpc.json", "{}")[0], 415)


class ListensEverywhere(HttpTest):
    """No host is told then: whoever asks knows one."""

    listen = "0.0.0.0:0"

    def test_says_the_port_alone(self):
        port = int(self.server.address.rsplit(":", 1)[1])
        self.assertNotEqual(port, 0)
        self.assertEqual(self.json("GET", "/v1/grpc.json")[1],
                         {"host": "", "port": port, "tls": False})


def speaks_six():
    try:
        with socket.socket(socket.AF_INET6) as tried:
            tried.bind(("::1", 0))
    except OSError:
        return False
    return True


@unittest.skipUnless(speaks_six(), "this machine has no IPv6")
class ListensEverywhereBySix(ListensEverywhere):
    listen = "[::]:0"


class Uploads(HttpTest):
    def test_a_file_in_parts_is_taken_up_where_it_ended(self):
        half = len(self.bytes) // 2
        total = len(self.bytes)
        status, said = self.put(self.bytes[:half], {"Content-Range": f"bytes 0-{half - 1}/{total}"})
        self.assertEqual((status, int(said["committedSize"])), (200, half), said)
        status, said = self.json("GET", f"/v1/grids/{self.digest}:upload")
        self.assertEqual(int(said["committedSize"]), half)
        status, said = self.put(self.bytes[half:],
                                {"Content-Range": f"bytes {half}-{total - 1}/{total}"})
        self.assertEqual((status, said.get("complete")), (200, True), said)
        status, said = self.put(self.bytes)  # stored already: the bytes need not come
        self.assertEqual((status, said.get("complete")), (200, True), said)

    def test_the_last_byte_again_keeps_a_file_that_came_whole_before_a_crash(self):
        other = self.folder / "whole.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.06", other], check=True)
        data = other.read_bytes()
        path, total = f"/v1/grids/{hashlib.sha256(data).hexdigest()}", len(data)
        self.assertEqual(self.ask("PUT", path, data[:-1], {"Content-Range": f"bytes 0-{total - 2}/{total}"})[0], 200)
        part = self.folder / "store" / "uploads" / (path.rpartition("/")[2] + ".part")
        self.assertEqual(part.stat().st_size, total - 1)
        with part.open("ab") as file:  # as a crash between the last write and its end leaves it
            file.write(data[-1:])
        status, said = self.json("GET", f"{path}:upload")
        self.assertEqual((status, int(said["committedSize"]), said.get("complete", False)), (200, total, False), said)
        status, _, body = self.ask("PUT", path, data[-1:], {"Content-Range": f"bytes {total - 1}-{total - 1}/{total}"})
        self.assertEqual((status, json.loads(body).get("complete")), (200, True), body)

    def test_curl_puts_a_file(self):
        other = self.folder / "other.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.02", other], check=True)
        digest = hashlib.sha256(other.read_bytes()).hexdigest()
        made = subprocess.run(
            ["curl", "-sS", "-T", other, f"http://{self.host}:{self.port}/v1/grids/{digest}"],
            capture_output=True, text=True, timeout=GENEROUS_END, check=True)
        self.assertTrue(json.loads(made.stdout)["complete"], made.stdout)

    def test_the_documents_commands_do_what_they_say(self):
        text = (ROOT / "docs" / "browser.md").read_text()
        script = re.search(r"^```bash\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[1]
        subprocess.run([binaries() / "make_fixture", "torus", "0.1", self.folder / "scan.vdb"], check=True)
        script = script.replace("127.0.0.1:8080", f"{self.host}:{self.port}")
        done = subprocess.run(["bash", "-ec", script.replace("curl ", "curl -sS --fail-with-body ")],
                              cwd=self.folder, capture_output=True, text=True, timeout=GENEROUS_END, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        self.assertEqual((answers[0]["complete"], answers[3]["state"]), (True, "JOB_STATE_QUEUED"))

    def test_the_document_has_every_path(self):
        text = (ROOT / "docs" / "browser.md").read_text()
        document = self.json("GET", "/v1/openapi.json")[1]
        for path, operations in document["paths"].items():
            for verb in operations:
                shown = path.replace("/grids/{id}", "/grids/{sha256}")
                self.assertIn(f"`{verb.upper()} {shown}`", text)

    def test_wrong_bytes_and_ranges_are_refused(self):
        self.assertEqual(self.ask("PUT", "/v1/grids/" + "0" * 64, b"not these")[0], 400)
        for content_range in ("bytes 0-1/2", "bytes 1-0/9", "0-8/9", "bytes 0-8/9 ", "bytes 0-8/*"):
            status = self.ask("PUT", "/v1/grids/" + "1" * 64, b"x" * 8,
                              {"Content-Range": content_range})[0]
            self.assertEqual(status, 400, content_range)
        self.assertEqual(self.ask("PUT", "/v1/grids/../etc", b"x")[0], 400)


class HttpDraining(HttpTest):
    def test_says_so_and_ends(self):
        wait_until(lambda: self.ask("GET", "/readyz")[0] == 200)
        idle = self.connection()
        idle.connect()
        self.assertEqual(self.server.terminate(), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
