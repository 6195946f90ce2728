"""A farm of hosts: one with the server and PostgreSQL and four with a worker each, network namespaces on one
bridge, that share a folder. Any worker is killed, and any host is cut off for longer than its leases and
comes back: jobs end with the same bytes, and nothing that comes too late is taken. Takes root.

    tests/farm/run hosts [--seed S]
"""

import os
import subprocess
import time

from farm_case import FarmTest, main, wait_until

WORKERS = 4


class Network:
    """Network namespaces on a switch, which is one too: they take all that was made with them away."""

    def __init__(self, names):
        self._made = []
        self._prefix = f"tet{os.getpid()}-"
        try:
            self._make("switch")
            self._ip("-n", self._name("switch"), "link", "add", "bridge", "type", "bridge")
            self._up("switch", "bridge")
            for number, name in enumerate(names, 1):
                self._make(name)
                self._ip("link", "add", "eth0", "netns", self._name(name), "type", "veth",
                         "peer", "name", f"to-{name}", "netns", self._name("switch"))
                self._ip("-n", self._name("switch"), "link", "set", f"to-{name}", "master", "bridge")
                self._ip("-n", self._name(name), "address", "add", f"10.77.0.{number}/24", "dev", "eth0")
                for host, link in ((name, "lo"), (name, "eth0"), ("switch", f"to-{name}")):
                    self._up(host, link)
        except BaseException:
            self.close()
            raise

    @staticmethod
    def _ip(*arguments):
        subprocess.run(["ip", *arguments], check=True)

    def _name(self, host):
        return self._prefix + host

    def _make(self, host):
        self._ip("netns", "add", self._name(host))
        self._made.append(host)

    def _up(self, host, link):
        self._ip("-n", self._name(host), "link", "set", link, "up")

    def on(self, host):
        """What to put before a command that is to run on a host."""
        return ["ip", "netns", "exec", self._name(host)]

    def cut_off(self, host):
        self._ip("-n", self._name("switch"), "link", "set", f"to-{host}", "down")

    def reconnect(self, host):
        self._up("switch", f"to-{host}")

    def close(self):
        for host in self._made:
            self._ip("netns", "delete", self._name(host))


class Hosts(FarmTest):
    def setUp(self):
        super().setUp()
        self.hosts = [f"worker{number}" for number in range(WORKERS)]
        self.network = Network(["main", *self.hosts])
        self.addCleanup(self.network.close)
        self.farm = self.make_farm("10.77.0.1", self.network.on("main"))
        self.grids = [self.farm.make_grid("sphere", voxel) for voxel in (0.02, 0.015)]
        self.workers = {host: self.start_worker(host) for host in self.hosts}

    def start_worker(self, host):
        return self.farm.start_worker(launch=self.network.on(host))

    def begin(self, worker):
        """Jobs of which this worker has a part."""
        jobs = {}
        for grid in self.grids:
            jobs[self.submit(self.farm, grid)] = grid
        wait_until(lambda: self.farm.leases(worker))
        time.sleep(self.chance.uniform(0, 0.1))
        return jobs

    def test_any_worker_is_killed(self):
        for host in self.hosts:
            jobs = self.begin(self.workers[host])
            held = self.farm.leases(self.workers[host])
            began = time.monotonic()
            self.farm.end_worker(self.workers[host])
            self.assert_done(self.farm, jobs)
            print(f"{host} killed over {len(held)} shards; all done {time.monotonic() - began:.1f} s later",
                  flush=True)
            self.workers[host] = self.start_worker(host)

    def test_any_host_is_cut_off_and_comes_back(self):
        refused = taken = 0
        for host in self.hosts:
            worker = self.workers[host]
            jobs = self.begin(worker)
            self.network.cut_off(host)
            held = self.farm.leases(worker)
            began = time.monotonic()
            wait_until(lambda cut=worker: not self.farm.leases(cut))
            lost = held - self.farm.committed()
            # It may be back in the middle of the others' work, or after it.
            if self.chance.random() < 0.5:
                self.assert_done(self.farm, jobs)
            self.network.reconnect(host)
            self.assert_done(self.farm, jobs)
            print(f"{host} cut off over {len(lost)} shards; all done {time.monotonic() - began:.1f} s later",
                  flush=True)
            wait_until(lambda back=worker, count=len(lost): len(back.log("shard_lost")) >= count)
            self.assertEqual(lost & self.farm.committed(), set())
            self.assert_works_again(worker)
            taken += len(lost)
            refused += len(worker.log("shard_lost"))
        print(f"{taken} shards were taken from hosts cut off; they lost {refused}, and committed none late")
        self.assertGreater(taken, 0)

    def assert_works_again(self, worker):
        def leased():
            if not self.farm.leases(worker):
                self.jobs[self.submit(self.farm, self.grids[0])] = self.grids[0]
            return self.farm.leases(worker)

        self.jobs = {}
        wait_until(leased)
        self.assert_done(self.farm, self.jobs)


if __name__ == "__main__":
    main(Hosts)
