"""Ten thousand jobs queued, by either engine: the server's memory does not grow with them.

    tests/farm/run queue
"""

import pathlib
import subprocess
import tempfile
import time
import unittest

from farm_case import Postgres, RunningServer, binaries

JOBS = 10_000
GROWTH_BYTES = 32 << 20


class TenThousandJobs(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.grid = self.folder / "sphere.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.1", self.grid], check=True)

    def submit(self, server, count):
        manifest = self.folder / f"{count}.txt"
        manifest.write_text("".join(f"{self.grid} --label number={number}\n" for number in range(count)))
        said = server.tetstream("job", "submit", "--manifest", manifest, "--parallel", 16,
                                "--journal", self.folder / f"{count}.jsonl", timeout=600)
        self.assertEqual(said.returncode, 0, said.stderr)

    def hold(self, engine, *options):
        with RunningServer(self.folder / engine, "--job-workers", "0", *options) as server:
            def memory():
                return server.samples()["process_resident_memory_bytes"]

            self.submit(server, 100)  # connections and caches are there
            before = memory()
            began = time.monotonic()
            self.submit(server, JOBS)
            seconds = time.monotonic() - began
            queued = memory()
            began = time.monotonic()
            listed = server.tetstream("job", "list", "--json", timeout=600)
            listing = time.monotonic() - began
            self.assertEqual(len(listed.stdout.splitlines()), JOBS + 100)
            after = memory()
        print(f"{engine}: {JOBS} jobs submitted in {seconds:.1f} s and listed in {listing:.1f} s; "
              f"resident {before / 2**20:.1f} MiB before, {queued / 2**20:.1f} queued, "
              f"{after / 2**20:.1f} listed", flush=True)
        self.assertLess(after - before, GROWTH_BYTES)

    def test_sqlite(self):
        self.hold("sqlite")

    def test_postgres(self):
        with Postgres() as postgres:
            self.hold("postgres", "--jobs", postgres.address)


if __name__ == "__main__":
    unittest.main(verbosity=2)
