"""The Slurm batch script, by a real slurmctld and two slurmd of this machine's (slurm-wlm, munge; root).

    tests/farm/run slurm
"""

import os
import pathlib
import re
import signal
import socket
import subprocess

from farm_case import GENEROUS_END, LEASE_SECONDS, FarmTest, binaries, main, wait_until

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "slurm" / "tetstream-workers.sbatch"

CONFIGURATION = """\
ClusterName=tetstream
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SlurmdParameters=config_overrides
SchedulerParameters=bf_interval=1,sched_interval=2
KillWait=10
NodeName=node1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 RealMemory=4096
NodeName=node2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2 RealMemory=4096
PartitionName=farm Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
"""


def unused_ports(count):
    probes = [socket.socket() for _ in range(count)]
    for probe in probes:
        probe.bind(("127.0.0.1", 0))
    ports = [probe.getsockname()[1] for probe in probes]
    for probe in probes:
        probe.close()
    return ports


class Cluster:
    """Of two nodes, in `folder`."""

    def __init__(self, folder):
        self.folder = folder
        for part in ("state", "spool-node1", "spool-node2"):
            (folder / part).mkdir(mode=0o755, parents=True)
        (folder / "munge.key").write_bytes(os.urandom(128))
        (folder / "munge.key").chmod(0o600)
        (folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], folder=folder, ports=unused_ports(3)))
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        self.programs = []
        try:
            self._start("munged", "-F", "-f", "--key-file", folder / "munge.key",
                        "--socket", folder / "munge.socket", "--pid-file", folder / "munge.pid",
                        "--seed-file", folder / "munge.seed", "--log-file", folder / "munge.log")
            wait_until((folder / "munge.socket").exists)
            self._start("slurmctld", "-D")
            for node in ("node1", "node2"):
                self._start("slurmd", "-D", "-N", node)
            wait_until(lambda: self("sinfo", "-h", "-o", "%D %T").strip() == "2 idle")
        except BaseException:
            self.close()
            raise

    def _start(self, program, *arguments):
        with open(self.folder / f"{program}.log", "ab") as log:
            self.programs.append(subprocess.Popen(
                [f"/usr/sbin/{program}", *arguments], stdout=log, stderr=log, env=self.environment,
                start_new_session=True))

    def __call__(self, *command):
        return subprocess.run(command, capture_output=True, text=True, timeout=GENEROUS_END, check=False,
                              env=self.environment, cwd=self.folder).stdout

    def submit(self, environment, *options):
        """The id of an array of workers."""
        said = subprocess.run(["sbatch", "--parsable", *options, SCRIPT], capture_output=True, text=True,
                              timeout=GENEROUS_END, check=False, cwd=self.folder,
                              env={**self.environment, **environment})
        if said.returncode != 0:
            raise AssertionError(said.stderr)
        return said.stdout.strip()

    def states(self, array):
        """JobState and ExitCode of each of an array's tasks."""
        return re.findall(r"JobState=(\S+).*?ExitCode=(\S+)",
                          self("scontrol", "-o", "show", "job", array))

    def logs(self):
        return "".join(path.read_text(errors="replace") for path in self.folder.glob("*.log"))

    def close(self):
        self("scancel", "--full", "--user=root")
        for program in reversed(self.programs):
            program.send_signal(signal.SIGTERM)
        for program in self.programs:
            try:
                program.wait(20)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()


class Slurm(FarmTest):
    def setUp(self):
        super().setUp()
        self.farm = self.make_farm()
        self.grid = self.farm.make_grid("sphere", 0.03)
        self.cluster = Cluster(self.farm.folder / "slurm")
        self.addCleanup(self.cluster.close)

    def submit_workers(self, *options, idle_seconds=2):
        return self.cluster.submit(
            {"TETSTREAM_STORE": str(self.farm.folder / "store"),
             "TETSTREAM_JOBS": self.farm.postgres.address,
             "TETSTREAM_JOB_LEASE_SECONDS": str(LEASE_SECONDS),
             "TETSTREAM_JOB_IDLE_SECONDS": str(idle_seconds),
             "PATH": f"{binaries()}:{os.environ['PATH']}"},
            "--array=1-2", "--cpus-per-task=1", "--mem=1G", *options)

    def ended(self, array):
        states = self.cluster.states(array)
        return states if all(state not in ("PENDING", "RUNNING", "COMPLETING")
                             for state, _ in states) else None

    def test_an_array_of_workers_does_the_jobs_and_ends(self):
        jobs = {self.submit(self.farm, self.grid): self.grid for _ in range(4)}
        array = self.submit_workers()
        try:
            self.assert_done(self.farm, jobs)
            states = wait_until(lambda: self.ended(array))
        except AssertionError:
            print(self.cluster.logs())
            raise
        self.assertEqual(states, [("COMPLETED", "0:0")] * 2, self.cluster.logs())
        workers = self.farm.postgres.rows("SELECT DISTINCT worker FROM shards")
        print(f"4 jobs by {len(workers)} workers")

    def test_one_that_is_cancelled_gives_its_shards_back(self):
        jobs = {self.submit(self.farm, self.grid): self.grid for _ in range(4)}
        array = self.submit_workers(idle_seconds=30)
        wait_until(lambda: self.farm.committed())
        self.cluster("scancel", f"{array}_1")
        self.assert_done(self.farm, jobs)
        stopped = self.cluster.folder / f"tetstream-{array}_1.log"
        wait_until(lambda: '"stopped"' in stopped.read_text())
        self.cluster("scancel", array)


if __name__ == "__main__":
    main(Slurm)
