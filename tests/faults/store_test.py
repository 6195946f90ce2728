"""Stores whose disk rots, fills, or is wanted by two servers.

    TETSTREAM_BIN=build/dev/bin TET_FAIL_WRITES_LIBRARY=build/dev/.../libfail_writes.so \\
        python3 tests/faults/store_test.py [unittest options]
"""

import itertools
import os
import pathlib
import subprocess
import unittest

from fault_case import GENEROUS_END, FaultTest, binaries, wait_until


class DamagedGrids(FaultTest):
    """A stored file is damaged while no server has it in memory."""

    def damaged(self, damage):
        """A server that meshes a grid whose stored file `damage` changed; its log lines of that."""
        with self.start() as first:
            self.assert_meshed(self.mesh(first))
        path = next(self.store.glob("grids/*/*"))
        damage(path)
        server = self.start()
        # The command line is told, uploads the grid again, and gets its mesh.
        self.assert_meshed(self.mesh(server))
        self.assertEqual(self.stored(), {self.digest()})
        self.assertEqual(server.samples()["tetstream_store_corrupt_total"], 1)
        refused = wait_until(lambda: [line for line in server.log("call") if line["status"] != "OK"])
        self.assertEqual([(line["status"], line["reason"]) for line in refused],
                         [("DATA_LOSS", "STORED_GRID_CORRUPT")])
        self.assertNotIn(str(self.folder), refused[0]["message"])
        return server.told("stored_grid_corrupt")

    def test_a_flipped_bit(self):
        def flip(path):
            with open(path, "r+b") as file:
                file.seek(path.stat().st_size // 2)
                byte = file.read(1)[0]
                file.seek(-1, os.SEEK_CUR)
                file.write(bytes([byte ^ 1]))

        damaged = self.damaged(flip)
        self.assertEqual(pathlib.Path(damaged[0]["moved"]).name, self.digest())
        self.assertTrue((self.store / "corrupt" / self.digest()).exists())

    def test_a_torn_write(self):
        def tear(path):
            with open(path, "r+b") as file:
                file.seek(path.stat().st_size // 2)
                file.write(bytes(path.stat().st_size - path.stat().st_size // 2))

        self.assertEqual(len(self.damaged(tear)), 1)

    def test_a_truncated_file(self):
        self.damaged(lambda path: os.truncate(path, path.stat().st_size - 1))

    def test_an_empty_file(self):
        self.damaged(lambda path: os.truncate(path, 0))

    def test_a_file_that_is_gone(self):
        with self.start() as first:
            self.assert_meshed(self.mesh(first))
        server = self.start()
        next(self.store.glob("grids/*/*")).unlink()
        self.assert_meshed(self.mesh(server))
        self.assertEqual(server.samples()["tetstream_store_corrupt_total"], 1)
        self.assertEqual(self.stored(), {self.digest()})


class FullDisk(FaultTest):
    """The n-th change to a file fails, and all after it: every fifth n, or with TET_EVERY_CHANGE set
    each one that there is."""

    step = 1 if "TET_EVERY_CHANGE" in os.environ else 5
    volumes = {"sphere": 0.02}
    spacing = ("--spacing", "0.1")  # it is the grid's file that has so many changes

    def meshed_on_a_full_disk(self, change):
        """Whether the disk became full at this change of an upload that must be all or nothing.

        Without jobs, whose database would be the first to miss the room.
        """
        mark = self.folder / "mark"
        environment = {"LD_PRELOAD": os.environ["TET_FAIL_WRITES_LIBRARY"],
                       "TET_FAIL_AT": str(change), "TET_FAIL_MARK": str(mark)}
        try:
            with self.start("--jobs", "off", environment=environment) as server:
                result = self.mesh(server)
        except AssertionError as error:
            self.assertIn("No space left on device", str(error))  # it did not even start
        else:
            if result.returncode == 0:
                self.assertEqual(self.stored(), {self.digest()})
            else:
                self.assertIn("No space left on device", result.stderr)
                self.assertNotIn(str(self.folder), result.stderr)
        self.stored()
        failed = mark.exists()
        mark.unlink(missing_ok=True)
        return failed

    def test_nothing_half_done_counts_and_everything_can_be_gone_on_with(self):
        changes = 0
        for change in itertools.count(1, self.step):
            if not self.meshed_on_a_full_disk(change):
                break
            changes += 1
            with self.start() as server:
                self.assert_meshed(self.mesh(server))
            self.assertEqual(self.stored(), {self.digest()})
            for path in self.store.glob("grids/*/*"):
                path.unlink()
            for part in ("grids", "uploads"):  # half of the times from the very beginning
                if changes % 2 == 0:
                    subprocess.run(["rm", "-r", self.store / part], check=True)
        print(f"the disk was full at {changes} changes, up to number {change - self.step}")
        self.assertGreater(changes, 5)


class OneServerAStore(FaultTest):
    def test_a_second_server_is_refused_by_name_and_a_killed_one_is_no_hindrance(self):
        first = self.start()
        second = subprocess.run(
            [binaries() / "tetstreamd", "--store", self.store, "--listen", "127.0.0.1:0"],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False)
        self.assertEqual(second.returncode, 3)
        self.assertIn(f"in use by another server, process {first.process.pid}", second.stderr)
        first.kill()
        self.assert_meshed(self.mesh(self.start()))

    def test_a_killed_servers_port_is_not_taken_for_the_next_ones(self):
        port_file = self.folder / "port"
        port_file.write_text("1\n")
        server = self.start("--port-file", port_file)
        self.assertEqual(server.address.rsplit(":", 1)[1], port_file.read_text().strip())


if __name__ == "__main__":
    unittest.main(verbosity=2)
