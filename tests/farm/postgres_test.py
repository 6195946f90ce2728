"""kill -9 of PostgreSQL under running jobs: server and workers go on by themselves when it is back,
nothing that was acknowledged is lost, and nothing is committed twice.

    tests/farm/run postgres --runs 50 [--seed S]
"""

import threading
import time

from farm_case import FarmTest, main


class DatabaseKills(FarmTest):
    runs = 3

    def one_run(self, farm, grids):
        jobs = {}

        def submit():
            for _ in range(3):
                grid = self.chance.choice(grids)
                jobs[self.submit(farm, grid)] = grid

        client = threading.Thread(target=submit)
        client.start()
        time.sleep(self.chance.uniform(0, 1.0))
        farm.postgres.kill()
        time.sleep(self.chance.uniform(0, 1.0))
        farm.postgres.start()
        began = time.monotonic()
        client.join()
        self.assertEqual(len(jobs), 3, "jobs were not acknowledged")
        self.assert_done(farm, jobs)
        return time.monotonic() - began

    def test_the_farm_goes_on(self):
        farm = self.make_farm()
        grids = [farm.make_grid("sphere", voxel) for voxel in (0.05, 0.04, 0.03)]
        for _ in range(2):
            farm.start_worker()
        seconds = []
        for run in range(self.runs):
            seconds.append(self.one_run(farm, grids))
            print(f"run {run}: all done {seconds[-1]:.1f} s after the restart", flush=True)
        self.assertEqual([program.process.poll() for program in (farm.server, *farm.workers)],
                         [None] * 3)
        print(f"{self.runs} kills; all done at most {max(seconds):.1f} s after the restart")


if __name__ == "__main__":
    main(DatabaseKills)
