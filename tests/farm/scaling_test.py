"""More workers, each with a quarter of a processor (a control group's quota): many jobs, and one large job.

    tests/farm/run scaling
"""

import os
import pathlib

from farm_case import FarmTest, main

GROUPS = pathlib.Path("/sys/fs/cgroup")
SHARE = 0.25  # of a processor
PERIOD_US = 20_000


class Quota:
    """A control group that has no more than a share of a processor; of either version of Linux's."""

    def __init__(self, number):
        second = (GROUPS / "cgroup.controllers").exists()
        self.folder = (GROUPS if second else GROUPS / "cpu") / f"tetstream{os.getpid()}-{number}"
        self.folder.mkdir()
        quota_us = int(SHARE * PERIOD_US)
        if second:
            (self.folder / "cpu.max").write_text(f"{quota_us} {PERIOD_US}")
        else:
            (self.folder / "cpu.cfs_period_us").write_text(str(PERIOD_US))
            (self.folder / "cpu.cfs_quota_us").write_text(str(quota_us))

    def within(self):
        """What to put before a command that is to run in the group."""
        return ["sh", "-c", f'echo $$ > {self.folder}/cgroup.procs && exec "$@"', "sh"]

    def close(self):
        self.folder.rmdir()


class Scaling(FarmTest):
    def setUp(self):
        super().setUp()
        self.quotas = []
        self.addCleanup(lambda: [quota.close() for quota in self.quotas])
        self.farm = self.make_farm()

    def seconds(self, workers, grids):
        """From the first claim to the last commit of a job for each grid, by so many workers."""
        jobs = {}
        for grid in grids:
            jobs[self.submit(self.farm, grid, "--levels", 0)] = grid
        for _ in range(workers):
            self.quotas.append(Quota(len(self.quotas)))
            self.farm.start_worker(launch=self.quotas[-1].within(), count_bricks=1024)
        said = self.farm.job("wait", *jobs)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        for worker in list(self.farm.workers):
            self.farm.end_worker(worker)
        listed = ", ".join(f"'{job}'" for job in jobs)
        (microseconds, ), = self.farm.postgres.rows(
            f"SELECT max(finish_us) - min(start_us) FROM jobs WHERE id IN ({listed})")
        return int(microseconds) / 1e6

    def scale(self, what, grids):
        # Chunks that are stored are not written again: what is measured is making them, not the disk.
        self.seconds(4, grids)
        alone = None
        for workers in (1, 2, 4):
            seconds = self.seconds(workers, grids)
            alone = alone or seconds
            print(f"{what}: {workers} workers of {SHARE} processors each: {seconds:.1f} s, "
                  f"{alone / seconds:.2f} times one", flush=True)
        return alone / seconds

    def test_many_jobs(self):
        self.assertGreater(self.scale("16 jobs", [self.farm.make_grid("sphere", 0.02)] * 16), 2)

    def test_one_large_job(self):
        self.assertGreater(self.scale("one job", [self.farm.make_grid("sphere", 0.008)]), 1.5)


if __name__ == "__main__":
    main(Scaling)
