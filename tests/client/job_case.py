"""What every test of `tetstream job` stands on: a real server that can be killed and started again."""

import json
import os
import pathlib
import subprocess
import tempfile

from command_case import DONE, CommandTest, binaries, unused_port, wait_until


class JobTest(CommandTest):
    volumes = {"sphere": 0.1}
    settings = ()  # of the server

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.address = f"127.0.0.1:{unused_port()}"
        cls.start_server()
        cls.addClassCleanup(lambda: cls.stop_server())

    @classmethod
    def start_server(cls):
        cls.server = subprocess.Popen(
            [binaries() / "tetstreamd", "--listen", cls.address,
             "--store", cls.inputs / "store", *map(str, cls.settings)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until(lambda: subprocess.run(
            [binaries() / "tetstream", "health", "--server", cls.address],
            capture_output=True, check=False).returncode == DONE)

    @classmethod
    def stop_server(cls):
        cls.server.terminate()
        cls.server.wait(60)

    @classmethod
    def kill_server(cls):
        cls.server.kill()
        cls.server.wait(30)

    def setUp(self):
        super().setUp()
        home = tempfile.TemporaryDirectory()
        self.addCleanup(home.cleanup)
        self.home = pathlib.Path(home.name)
        self.environment = {**os.environ, "XDG_STATE_HOME": str(self.home)}

    def job(self, command, *arguments, **options):
        return self.tetstream("job", command, *arguments, "--server", self.address,
                              env=self.environment, **options)

    def start_job_command(self, command, *arguments):
        return subprocess.Popen(
            [binaries() / "tetstream", "job", command, *map(str, arguments),
             "--server", self.address],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=self.environment)

    def objects(self, result):
        """The lines of a command that succeeded, as JSON."""
        self.assert_done(result)
        return [json.loads(line) for line in result.stdout.splitlines()]

    def submit(self, *arguments):
        return [job["name"] for job in self.objects(self.job("submit", *arguments, "--json"))]

    def list(self, *arguments):
        return self.objects(self.job("list", *arguments, "--json"))

    def journals(self):
        return list(self.home.rglob("*.jsonl"))
