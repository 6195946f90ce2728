"""kill -9 of the server at any moment: what was acknowledged is there, what was cut is gone on with.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/kill_test.py [--runs N] [--seed S] [Kills]

Each run begins with an empty store and kills the server twice while a client uploads and meshes.
"""

import argparse
import random
import signal
import subprocess
import sys
import time
import unittest

from fault_case import (
    GENEROUS_END, FaultTest, RunningServer, binaries, unused_port, wait_until)


class Kills(FaultTest):
    volumes = {"sphere": 0.02, "torus": 0.02, "gyroid": 0.03}
    runs = 6
    seed = None

    def client(self, address, kind):
        client = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / f"{kind}.vdb",
             "-o", self.folder / f"{kind}.vtu", "--server", address],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(client.kill)
        return client

    def one_run(self, chance):
        """Kills at two moments of a client's work; returns how long that work took."""
        self.store = self.folder / f"store{chance.random()}"
        kind = chance.choice(sorted(self.volumes))
        server = RunningServer(self.store, listen=f"127.0.0.1:{unused_port()}")
        acknowledged = set()
        try:
            for _ in range(2):
                client = self.client(server.address, kind)
                # It has asked what is missing: from here on it is the server's to be there again.
                wait_until(lambda at=server: at.log("call"))
                time.sleep(chance.uniform(0, self.clean_seconds))
                address = server.address
                acknowledged |= {line["grid"] for line in server.log("call")
                                 if line["method"] == "StreamMesh" and line["status"] == "OK"}
                server.close()
                client.send_signal(signal.SIGSTOP)  # however long a start takes, its patience does not end
                # Right after the kill: acknowledged files are there, and no others' bytes.
                self.assertLessEqual(acknowledged, self.stored())
                server = RunningServer(self.store, listen=address)
                client.send_signal(signal.SIGCONT)
                _, errors = client.communicate(timeout=GENEROUS_END)
                self.assertEqual(client.returncode, 0, errors)
                mesh = self.folder / f"{kind}.vtu"
                self.assertTrue(mesh.read_bytes() == self.expected[kind])
                mesh.unlink()
                acknowledged.add(self.digest(kind))
                kind = chance.choice(sorted(self.volumes))
            self.assertLessEqual(acknowledged, self.stored())
            self.assertEqual(list(self.store.glob("uploads/*")), [])
            self.assertEqual(server.samples()["tetstream_store_corrupt_total"], 0)
        finally:
            server.close()

    def test_every_moment_is_one_to_recover_from(self):
        seed = self.seed if self.seed is not None else random.randrange(1 << 32)
        print(f"seed {seed}, {self.runs} runs")
        chance = random.Random(seed)
        with self.start() as server:
            began = time.monotonic()
            self.assert_meshed(self.mesh(server, "torus"), "torus")
            self.clean_seconds = time.monotonic() - began
        for run in range(self.runs):
            with self.subTest(seed=seed, run=run):
                self.one_run(chance)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=Kills.runs)
    parser.add_argument("--seed", type=int)
    options, rest = parser.parse_known_args()
    Kills.runs, Kills.seed = options.runs, options.seed
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
