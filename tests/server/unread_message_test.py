"""Messages that are refused before any call sees them: compressed, malformed, and without a token.

    TETSTREAM_BIN=build/dev/bin python3 tests/server/unread_message_test.py [unittest options]
"""

import concurrent.futures
import pathlib
import re
import struct
import subprocess
import tempfile
import unittest
import zlib

import grpc

from raw_http2 import RawCall, field, message
from running_server import GENEROUS_END, RunningServer, binaries, wait_until

MIB = 1 << 20
INFLATED_MIB = 1000
MOST_GROWTH = 64 * MIB  # a fraction of one such message
PROTOS = pathlib.Path(__file__).resolve().parents[2] / "proto" / "tetstream" / "v1"


def methods():
    """{path: whether the client sends a stream} of every method there is."""
    found = {"/grpc.health.v1.Health/Check": False}
    for proto in PROTOS.glob("*.proto"):
        service = None
        for line in proto.read_text().splitlines():
            if begun := re.match(r"service (\w+)", line):
                service = begun[1]
            elif rpc := re.match(r"\s+rpc (\w+)\((stream )?", line):
                found[f"/tetstream.v1.{service}/{rpc[1]}"] = bool(rpc[2])
    return found


def compressed_zeros(wbits, mebibytes=INFLATED_MIB):
    """About 1 KB for each mebibyte of zeros: compressed once, as every other one would be after a full flush.

    The sum at the end is of them all, so that it is a message that could be inflated.
    """
    compressor = zlib.compressobj(9, zlib.DEFLATED, wbits)
    zeros = bytes(MIB)
    begin = compressor.compress(zeros) + compressor.flush(zlib.Z_FULL_FLUSH)
    repeated = compressor.compress(zeros) + compressor.flush(zlib.Z_FULL_FLUSH)
    end = compressor.flush()
    size = mebibytes * MIB
    if wbits > 15:  # gzip: CRC-32 and size, little-endian
        crc = 0
        for _ in range(mebibytes):
            crc = zlib.crc32(zeros, crc)
        end = end[:-8] + struct.pack("<II", crc, size % (1 << 32))
    else:  # zlib: Adler-32, of which zeros change one half alone, big-endian
        end = end[:-4] + struct.pack(">HH", size % 65521, 1)
    return begin + repeated * (mebibytes - 1) + end


class CompressedZeros(unittest.TestCase):
    def test_are_what_a_reader_inflates_to_all_their_zeros(self):
        for wbits in (15, 31):
            self.assertEqual(zlib.decompress(compressed_zeros(wbits, 5), wbits), bytes(5 * MIB))
            self.assertLess(len(compressed_zeros(wbits)), 2 * MIB)


class UnreadMessageTest(unittest.TestCase):
    """A server that wants tokens. `token` is a good one."""

    @classmethod
    def setUpClass(cls):
        folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        made = subprocess.run([binaries() / "tetstreamd", "--new-token", "alice"], check=True,
                              capture_output=True, text=True, timeout=GENEROUS_END)
        tokens = folder / "tokens.toml"
        tokens.touch(mode=0o600)
        tokens.write_text(made.stdout)
        cls.token = re.search(r"tetstream_[\w-]+", made.stderr)[0]
        cls.server = cls.enterClassContext(RunningServer(folder / "store", "--tokens", tokens))
        cls.port = int(cls.server.address.rsplit(":", 1)[1])

    def call(self, method, *headers, with_token=False):
        bearer = [("authorization", f"Bearer {self.token}")] if with_token else []
        call = RawCall(self.port, method, headers=[*headers, *bearer])
        self.addCleanup(call.close)
        return call

    def memory(self):
        """The most that the server has had, in bytes."""
        status = pathlib.Path(f"/proc/{self.server.process.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+) kB", status)[1]) << 10

    def counted(self, why):
        return self.server.samples()[f'tetstream_unread_messages_total{{why="{why}"}}']


class CompressedMessages(UnreadMessageTest):
    def test_are_refused_by_every_method_and_take_no_memory(self):
        kinds = {"gzip": compressed_zeros(31), "deflate": compressed_zeros(15)}
        before, refused = self.memory(), 0
        for method in methods():
            for encoding, bytes_sent in kinds.items():
                for with_token in (False, True):
                    call = self.call(method, ("grpc-encoding", encoding), with_token=with_token)
                    call.send(message(bytes_sent, compressed=True))
                    self.assertTrue(call.wait_for_end(), method)
                    self.assertIn(f"Compression algorithm '{encoding}' is disabled".encode(),
                                  call.trailers, method)
                    call.close()
                    refused += 1
        self.assertLess(self.memory() - before, MOST_GROWTH)
        self.assertGreaterEqual(refused, 4 * 20)
        self.assertEqual(self.counted("compressed"), refused)
        lines = self.server.told("unread_message", why="compressed")
        # One a second; each says how many it stands for, but for those since the last one.
        self.assertLessEqual(sum(1 + line["left_out"] for line in lines), refused)

    def test_that_do_not_say_so_are_not_inflated(self):
        before = self.memory()
        call = self.call("/tetstream.v1.MeshService/EstimateMesh", with_token=True)
        call.send(message(compressed_zeros(31), compressed=True))
        call.finish()
        self.assertTrue(call.wait_for_end())
        self.assertLess(self.memory() - before, MOST_GROWTH)


class CompressedAnswers(unittest.TestCase):
    """Our clients beside a server that compresses."""

    class Zeros(grpc.GenericRpcHandler):
        """Answers whatever is asked with a message that is small while it is compressed."""

        def service(self, _):
            return grpc.unary_unary_rpc_method_handler(lambda request, context: bytes(200 * MIB))

    def setUp(self):
        workers = self.enterContext(concurrent.futures.ThreadPoolExecutor())
        server = grpc.server(workers, handlers=[self.Zeros()], compression=grpc.Compression.Gzip,
                             options=[("grpc.max_send_message_length", -1)])
        self.address = f"127.0.0.1:{server.add_insecure_port('127.0.0.1:0')}"
        server.start()
        self.addCleanup(lambda: server.stop(None).wait())

    def test_are_refused_in_words_that_say_why(self):
        for command in (["health"], ["job", "list"]):
            result = subprocess.run([binaries() / "tetstream", *command, "--server", self.address],
                                    capture_output=True, text=True, timeout=GENEROUS_END)
            self.assertEqual(result.returncode, 3, result)
            self.assertIn("Compression algorithm 'gzip' is disabled", result.stderr)


class MalformedMessages(UnreadMessageTest):
    # A field that says it has more bytes than there are.
    MALFORMED = field(1, b"twelve bytes")[:-3]
    # Their calls take the bytes as they are, ask for the token, and tell of themselves.
    TAKE_BYTES = ("StreamMesh", "ReadJobResult")

    def test_are_told_counted_and_logged(self):
        of_one_message = [method for method, stream in methods().items()
                          if not stream and "tetstream" in method
                          and not method.endswith(self.TAKE_BYTES)]
        self.assertGreater(len(of_one_message), 10)
        before = self.counted("unreadable")
        for method in of_one_message:
            call = self.call(method)
            call.ask(self.MALFORMED)
            self.assertTrue(call.wait_for_end(), method)
            self.assertIn(b"the message is not one that this method takes", call.trailers, method)
        self.assertEqual(self.counted("unreadable") - before, len(of_one_message))
        line = wait_until(lambda: self.server.log("unread_message"))[0]
        self.assertEqual(line["why"], "unreadable")
        self.assertIn("/tetstream.v1.", line["method"])
        self.assertTrue(line["peer"].startswith("ipv4:127.0.0.1:"))


if __name__ == "__main__":
    unittest.main()
