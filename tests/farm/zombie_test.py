"""Workers that are stopped (SIGSTOP) for longer than their leases, and go on (SIGCONT) when others have
their shards: what they then commit is refused.

    tests/farm/run zombie --runs 100 [--seed S]
"""

import signal
import time

from farm_case import FarmTest, main, wait_until


class Zombies(FarmTest):
    runs = 4

    def setUp(self):
        super().setUp()
        self.farm = self.make_farm()
        self.grids = [self.farm.make_grid("sphere", voxel) for voxel in (0.05, 0.04, 0.03)]

    def one_run(self, workers):
        jobs = {}

        def at_work():
            if not self.farm.postgres.rows("SELECT number FROM queue LIMIT 1"):
                grid = self.chance.choice(self.grids)
                jobs[self.submit(self.farm, grid)] = grid
            return [worker for worker in workers if self.farm.leases(worker)]

        zombie = self.chance.choice(wait_until(at_work))
        time.sleep(self.chance.uniform(0, 0.05))
        zombie.process.send_signal(signal.SIGSTOP)
        held = self.farm.leases(zombie)
        # Nobody's any more, or somebody else's.
        wait_until(lambda: not self.farm.leases(zombie))
        # What the database had got before the stop was in time.
        lost = held - self.farm.committed()
        time.sleep(self.chance.uniform(0, 0.5))
        zombie.process.send_signal(signal.SIGCONT)
        self.assert_done(self.farm, jobs)
        self.assertEqual(lost & self.farm.committed(), set(), "a stale commit was taken")
        return len(lost)

    def test_a_late_commit_is_refused(self):
        workers = [self.farm.start_worker() for _ in range(2)]
        lost = zombies = stops = 0
        while zombies < self.runs and stops < 3 * self.runs:
            taken = self.one_run(workers)
            stops += 1
            lost += taken
            zombies += taken > 0
            print(f"stop {stops}: {taken} shards lost", flush=True)
        refused = sum(line["message"].find("no longer holds it") >= 0
                      for worker in workers for line in worker.log("shard_lost"))
        given_up = sum(len(worker.log("shard_lost")) for worker in workers) - refused
        print(f"{stops} stops made {zombies} zombies, from whom {lost} shards were taken; when they went on "
              f"{refused} commits were refused and {given_up} shards given up; no stale commit was taken")
        self.assertEqual(zombies, self.runs)


if __name__ == "__main__":
    main(Zombies)
