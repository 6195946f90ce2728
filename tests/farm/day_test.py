#!/usr/bin/python3
"""A day's mixed load compressed into an hour, on demand: nothing grows, and nothing acknowledged is lost.

    tests/farm/run day [--minutes N] [--seed S]     # as root: the store has a disk of its own, a tmpfs

PostgreSQL, two servers and two workers over one store.
Clients stream (some are killed meanwhile, some take nothing), submit jobs, hold sessions, upload whole files
and parts of files. The other server and one worker are killed and started again all the time; the disk is filled by others now and then, and the
clock of the server that stays is set an hour ahead and back. Of what stays, the server and the worker,
memory, descriptors, threads and temporary files are told over time, and compared when nothing goes on:
after a first round of everything, and at the end.
"""

import argparse
import collections
import hashlib
import os
import pathlib
import random
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "server"), str(HERE.parent / "faults")]

from neighbours_test import MESHES, WIDE, GRIDS, encoded  # noqa: E402
from postgres import Postgres  # noqa: E402
from raw_http2 import RawCall, field, message  # noqa: E402
from running_server import RunningServer, RunningWorker, binaries, unused_port, wait_until  # noqa: E402

MIB = 1 << 20
DISK_MIB, RESERVE = 512, 16 * MIB
SPACINGS = ("0.05", "0.06", "0.07", "0.08")
# What a process may have more of at the end than after the first round of everything.
MORE_DESCRIPTORS, MORE_THREADS, MORE_MEMORY = 4, 4, 48 * MIB

GRID_FILES, RESULTS = 'tetstream_evictions_total{what="grid_file"}', "tetstream_result_evictions_total"

Sample = collections.namedtuple("Sample", "resident descriptors threads temporary")


class Clock:
    """How far ahead a process believes to be; it sees a change at once."""

    def __init__(self, path):
        self.path = path
        self.set(0)

    def set(self, seconds):
        with open(self.path, "r+b" if self.path.exists() else "wb") as file:
            file.write(struct.pack("<q", seconds))

    def environment(self):
        built = binaries().parent / "tests" / "faults" / "libshift_clock.so"
        return {"LD_PRELOAD": os.environ.get("TET_SHIFT_CLOCK_LIBRARY", str(built)),
                "TET_CLOCK_AHEAD_FILE": str(self.path)}


class Day:
    """The farm, and what its clients were promised."""

    def __init__(self, folder, chance):
        self.folder, self.chance = folder, chance
        self.disk, self.inputs = folder / "disk", folder / "inputs"
        for made in (self.disk, self.inputs, folder / "tmp"):
            made.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK_MIB}m", "none", self.disk], check=True)
        self.store = self.disk / "store"
        self.clock = Clock(folder / "ahead")
        self.lock = threading.Lock()
        self.counts = collections.Counter()
        self.jobs = {}  # of those that were acknowledged, the spacing
        self.uploaded = collections.deque(maxlen=20)  # the last ones: older ones may be evicted
        self.wrong = []
        self.evicted_by_others = self.evicted_by_killed = 0  # grids, results
        self.stopping = threading.Event()
        self.grid = self.inputs / "sphere.vdb"
        subprocess.run([binaries() / "make_fixture", "sphere", "0.05", self.grid], check=True)
        self.expected = {spacing: self.mesh_here(spacing) for spacing in SPACINGS}
        self.addresses = [f"127.0.0.1:{unused_port()}" for _ in range(2)]

    def start(self):
        self.postgres = Postgres()
        environment = {"TMPDIR": str(self.folder / "tmp")}
        self.options = ("--jobs", self.postgres.address, "--job-lease-seconds", "2",
                        "--disk-reserve-bytes", RESERVE, "--store-bytes", 96 * MIB,
                        "--result-bytes", 128 * MIB, "--resident-bytes", 32 * MIB, "--plan-bytes", 64 * MIB)
        self.stays = RunningServer(self.store, *self.options, "--job-workers", "0", listen=self.addresses[0],
                                   environment=environment | self.clock.environment())
        self.goes = self.start_other()
        self.worker_stays = self.start_worker(environment)
        self.worker_goes = self.start_worker(environment)

    def start_other(self):
        """Clients turn to this one where the other fails, and the other way round."""
        return RunningServer(self.store, *self.options, "--job-workers", "0", listen=self.addresses[1])

    def start_worker(self, environment=None):
        return RunningWorker(self.store, self.postgres.address, "--job-lease-seconds", "2",
                             "--disk-reserve-bytes", RESERVE, "--result-bytes", 128 * MIB,
                             "--job-workers", "1", environment=environment)

    def mesh_here(self, spacing):
        mesh = self.inputs / f"{spacing}.vtu"
        subprocess.run([binaries() / "tetstream", "mesh", self.grid, "-o", mesh, "--spacing", spacing],
                       check=True, stdout=subprocess.DEVNULL)
        return mesh.read_bytes()

    def client(self, *arguments, servers=None):
        return subprocess.Popen(
            [binaries() / "tetstream", *map(str, arguments), "--server", servers or ",".join(self.addresses)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def job(self, *arguments):
        return self.client("job", *arguments, servers=self.addresses[0])

    def scratch(self, ending):
        return self.folder / f"{threading.get_ident()}-{time.monotonic_ns()}{ending}"

    def count(self, what):
        with self.lock:
            self.counts[what] += 1

    def port(self):
        return int(self.addresses[0].rsplit(":", 1)[1])

    # What clients do, each once.

    def stream(self):
        spacing, mesh = self.chance.choice(SPACINGS), self.scratch(".vtu")
        addresses = self.addresses if self.chance.random() < 0.7 else self.addresses[::-1]
        client = self.client("mesh", self.grid, "-o", mesh, "--spacing", spacing,
                             servers=",".join(addresses))
        if self.chance.random() < 0.3:
            time.sleep(self.chance.uniform(0, 0.2))
            client.kill()
            self.count("streams killed by their clients")
        said = client.communicate()
        if client.returncode == 0:
            self.count("streams")
            if mesh.read_bytes() != self.expected[spacing]:
                self.wrong.append(f"a stream's bytes at {spacing}")
        elif client.returncode > 0:
            self.count("streams that failed, told why")
        elif client.returncode not in (-9,):
            self.wrong.append(f"the client ended with {client.returncode}: {said[1]}")
        for left in self.folder.glob(mesh.stem + "*"):
            left.unlink()

    def upload(self):
        """A file that nobody has."""
        grid, mesh = self.scratch(".vdb"), self.scratch(".vtu")
        subprocess.run([binaries() / "make_fixture", "sphere", str(self.chance.uniform(0.04, 0.06)), grid],
                       check=True)
        client = self.client("mesh", grid, "-o", mesh, "--spacing", "0.08", servers=self.addresses[0])
        client.communicate()
        if client.returncode == 0:
            self.count("uploads")
            self.uploaded.append(hashlib.sha256(grid.read_bytes()).hexdigest())
        else:
            self.count("uploads that failed, told why")
        for left in (grid, mesh):
            left.unlink(missing_ok=True)

    def part_of_an_upload(self):
        content = os.urandom(8) + bytes(MIB)
        call = RawCall(self.port(), GRIDS + "UploadGrid")
        name = "grids/" + os.urandom(32).hex()
        call.send(message(field(1, field(1, name) + field(2, len(content)))), seconds=1)
        call.send(message(field(2, field(2, content)))[:-1], seconds=1)
        call.socket.close()
        self.count("uploads given up")

    def slow_stream(self):
        call = RawCall(self.port(), MESHES + "StreamMesh", window=20000)
        call.ask(encoded("StreamMeshRequest",
                         "mesh { scene { nodes { sphere { radius: 1 } } } spacing: 0.03 levels: 0 }"))
        self.stopping.wait(1)
        call.socket.close()
        self.count("streams that nobody read")

    def session(self):
        call = RawCall(self.port(), MESHES + "RemeshSession", window=WIDE)
        frames = ["tell_refusals: true start { spacing: 0.08 scene { nodes { sphere { radius: 1 } } } }"]
        frames += [f"frame {{ scene {{ nodes {{ sphere {{ radius: {radius} }} }} }} }}"
                   for radius in (1.01, -1, 1.02, 1.03)]
        for frame in frames:
            call.send(message(encoded("RemeshRequest", frame)), seconds=2)
            call.listen(0.05)
        if self.chance.random() < 0.5:
            call.finish()
            call.wait_for_end(5)
        call.socket.close()
        self.count("sessions")

    def submit(self):
        spacing = self.chance.choice(SPACINGS)
        client = self.job("submit", self.grid, "--spacing", spacing, "--skip-cache", "--json",
                          "--max-attempts", "100", "--journal", self.scratch(".journal"))
        said, _ = client.communicate()
        if client.returncode != 0:
            return self.count("jobs that were not taken, told why")
        name = said.split('"name"', 1)[1].split('"', 2)[1].removeprefix("jobs/")
        with self.lock:
            self.jobs[name] = spacing
            waits = self.chance.random() < 0.5
        self.count("jobs")
        if waits:  # so that not all are queued
            self.job("wait", name, "--patience", "20s").communicate()
        return None

    # What the world does.

    def kill_one(self):
        if self.chance.random() < 0.5:
            self.evicted_by_others += self.evictions(self.goes, GRID_FILES)
            self.evicted_by_killed += self.evictions(self.goes, RESULTS)
            self.goes.close()
            self.goes = self.start_other()
            self.count("servers killed")
        else:
            self.evicted_by_killed += self.evictions(self.worker_goes, RESULTS)
            self.worker_goes.close()
            self.worker_goes = self.start_worker()
            self.count("workers killed")
        self.stopping.wait(self.chance.uniform(5, 10))

    @staticmethod
    def evictions(program, what):
        """One that is killed may evict once more after it was asked."""
        try:
            # A store that has not answered since the program began has told nothing yet.
            return program.samples().get(what, 0)
        except OSError:
            return 0

    def fill_disk(self):
        self.stopping.wait(self.chance.uniform(15, 30))
        path = self.disk / "others"
        with open(path, "wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(MIB))
            except OSError:
                pass
        self.stopping.wait(5)
        path.unlink()
        self.count("disks filled")

    def set_clock(self):
        self.stopping.wait(self.chance.uniform(15, 30))
        self.clock.set(3600)
        self.stopping.wait(5)
        self.clock.set(0)
        self.count("clocks set ahead and back")

    MUST = ("streams", "uploads", "jobs", "sessions", "workers killed", "servers killed", "disks filled",
            "clocks set ahead and back")
    CLIENTS = (stream, stream, upload, part_of_an_upload, slow_stream, session, submit)
    WORLD = (kill_one, fill_disk, set_clock)

    def again(self, act):
        while not self.stopping.is_set():
            try:
                act(self)
            except OSError:  # the server hung up
                self.count("calls that were cut")
                time.sleep(0.1)
            except Exception as error:
                self.wrong.append(f"{act.__name__} ended: {error!r}")
                raise
            time.sleep(0.05)

    def go_on_for(self, seconds):
        """Samples of what stays, a second apart."""
        self.stopping.clear()
        threads = [threading.Thread(target=self.again, args=(act,)) for act in self.CLIENTS + self.WORLD]
        for thread in threads:
            thread.start()
        samples, end = [], time.monotonic() + seconds
        while time.monotonic() < end:
            samples.append(self.sample())
            time.sleep(1)
        self.stopping.set()
        for thread in threads:
            thread.join()
        return samples

    def sample(self):
        told = {}
        for name, program in (("server", self.stays), ("worker", self.worker_stays)):
            process = pathlib.Path(f"/proc/{program.process.pid}")
            status = dict(line.split(":", 1) for line in (process / "status").read_text().splitlines())
            told[name] = Sample(int(status["VmRSS"].split()[0]) << 10, len(list((process / "fd").iterdir())),
                                int(status["Threads"]), self.temporary())
        return told

    def temporary(self):
        """Files that are not whole yet, of the store and of the system's folder for them."""
        unfinished = [*self.store.glob("uploads/*"), *(self.folder / "tmp").iterdir()]
        # A walk that minds no folder that goes meanwhile, as that of a result does.
        stored = (name for _, folders, files in os.walk(self.store) for name in (*folders, *files))
        return len(unfinished) + sum(".tmp" in name for name in stored)

    def rest(self):
        """What stays, once nothing goes on."""
        def is_quiet():
            samples = self.stays.samples()
            return samples["tetstream_meshes_running"] == 0 and samples["tetstream_meshes_queued"] == 0
        wait_until(is_quiet)
        settled = self.sample()
        # Connections and leases end in their own time: until nothing changes for two seconds.
        while True:
            time.sleep(2)
            now = self.sample()
            if all(now[name][1:3] == settled[name][1:3] for name in now):
                return now
            settled = now

    def fetch(self, job, mesh):
        """What went wrong; nothing if the mesh is there."""
        fetched = self.job("fetch", job, "-o", mesh)
        errors = fetched.communicate()[1]
        return errors or "it failed" if fetched.returncode != 0 else None

    def result_evictions(self):
        programs = (self.stays, self.goes, self.worker_stays, self.worker_goes)
        return self.evicted_by_killed + sum(self.evictions(program, RESULTS) for program in programs)

    def lost(self):
        """What was acknowledged and is not there, or has other bytes."""
        lost = list(self.wrong)
        gone = [digest for digest in self.uploaded
                if not (self.store / "grids" / digest[:2] / digest).is_file()]
        evicted = self.evicted_by_others + sum(
            self.evictions(server, GRID_FILES) for server in (self.stays, self.goes))
        if len(gone) > evicted + self.counts["servers killed"]:
            lost += [f"the grid {digest}" for digest in gone]
        elif gone:
            self.counts["of the last grids, evicted for room on the disk"] = len(gone)
        lost += [f"there were no {what}" for what in self.MUST if self.counts[what] == 0]
        for job, spacing in self.jobs.items():
            waited = self.job("wait", job, "--patience", "300s")
            said = waited.communicate()
            if waited.returncode != 0:
                lost.append(f"job {job}: {said}")
                continue
            mesh = self.scratch(".vtu")
            errors = self.fetch(job, mesh)
            if errors and "retry the job to make it again" in errors and self.result_evictions() > 0:
                # While others fill the disk, results make room; that is told, and they can be made again.
                self.count("results evicted since, made again")
                self.job("retry", job).communicate()
                self.job("wait", job, "--patience", "300s").communicate()
                errors = self.fetch(job, mesh)
            if errors:
                lost.append(f"the result of job {job}: {errors}")
                continue
            if mesh.read_bytes() != self.expected[spacing]:
                lost.append(f"the bytes of job {job}")
            self.count("results fetched")
            mesh.unlink()
        for name, program in (("server", self.stays), ("worker", self.worker_stays)):
            if program.process.poll() is not None:
                lost.append(f"the {name} that stays ended with {program.process.returncode}")
            lost += [f"the {name}: {line}" for line in program.log("exception")]
        return lost

    def close(self):
        for name in ("goes", "worker_goes", "stays", "worker_stays", "postgres"):
            if hasattr(self, name):
                getattr(self, name).close()
        subprocess.run(["umount", "-l", self.disk], check=True)


def told(sample):
    return (f"{sample.resident / MIB:.0f} MiB, {sample.descriptors} descriptors, {sample.threads} threads, "
            f"{sample.temporary} temporary files")


def grown(name, first, last):
    """What is not flat."""
    limits = (MORE_MEMORY, MORE_DESCRIPTORS, MORE_THREADS, 0)
    return [f"the {name} has {now} {what} at rest, and had {before}"
            for what, before, now, more in zip(Sample._fields, first, last, limits) if now > before + more]


def tell_thirds(samples):
    third = max(1, len(samples) // 3)
    for name in ("server", "worker"):
        for at, part in enumerate((samples[:third], samples[third:2 * third], samples[2 * third:])):
            middle = Sample(*(statistics.median(values) for values in zip(*(one[name] for one in part))))
            most = max(one[name].resident for one in part)
            print(f"{name}, third {at + 1}: in the middle {told(middle)}; at most {most / MIB:.0f} MiB")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 32))
    options = parser.parse_args()
    if os.getuid() != 0:
        sys.exit("only root mounts a disk of its own")
    print(f"seed {options.seed}, {options.minutes:g} minutes", flush=True)
    with tempfile.TemporaryDirectory(prefix="tetstream-day-") as folder:
        day = Day(pathlib.Path(folder), random.Random(options.seed))
        try:
            day.start()
            day.go_on_for(max(20.0, 3 * options.minutes))  # whatever is made once, is made
            first = day.rest()
            print("at rest after the first round:", *(f"{n} {told(s)};" for n, s in first.items()), flush=True)
            tell_thirds(day.go_on_for(60 * options.minutes))
            last = day.rest()
            print("at rest at the end:", *(f"{n} {told(s)};" for n, s in last.items()), flush=True)
            failed = [line for name in first for line in grown(name, first[name], last[name])]
            failed += day.lost()
        finally:
            day.close()
    for what, count in sorted(day.counts.items()):
        print(f"{count:6} {what}")
    print("nothing grew, and nothing was lost" if not failed else "\n".join(map(str, failed)))
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
