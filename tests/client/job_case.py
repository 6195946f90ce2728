"""What every test of `tetstream job` stands on."""

import json
import os
import pathlib
import subprocess
import tempfile

from command_case import ServerTest, binaries


class JobTest(ServerTest):
    volumes = {"sphere": 0.1}

    def setUp(self):
        super().setUp()
        home = tempfile.TemporaryDirectory()
        self.addCleanup(home.cleanup)
        self.home = pathlib.Path(home.name)
        self.environment = {**os.environ, "XDG_STATE_HOME": str(self.home)}

    def job(self, command, *arguments, **options):
        return self.tetstream("job", command, *arguments, "--server", self.address,
                              env=self.environment, **options)

    def start_job_command(self, command, *arguments, server=None, stdout=subprocess.PIPE):
        return subprocess.Popen(
            [binaries() / "tetstream", "job", command, *map(str, arguments),
             "--server", server or self.address],
            stdout=stdout, stderr=subprocess.PIPE, text=True, env=self.environment)

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
