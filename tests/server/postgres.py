"""A PostgreSQL server of a test's own, which may be killed and started again."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

from running_server import GENEROUS_END

PROGRAMS = pathlib.Path("/usr/lib/postgresql/15/bin")
END = "end of the rows"
HOME = pathlib.Path(__file__).parent / "jobs" / "store" / "postgres_home.h"


def emptying():
    """What leaves a job store's tables as they are made, as the store's own tests do and check."""
    return re.search(r'R"sql\((.*?)\)sql"', HOME.read_text(encoding="ascii"), re.DOTALL)[1]


class Postgres:
    """Debian's PostgreSQL 15 in a folder of its own, on a Unix socket there and on `host`, if given.

    What was committed outlives a killed server, and no power cut. It does not run as root: where the test does, it is the user postgres. `launch` is put before its
    command, and must become it (exec).
    """

    def __init__(self, host="", launch=(), settings=()):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tetstream-postgres-"))
        self._user = []
        if os.getuid() == 0:
            shutil.chown(self.folder, "postgres", "postgres")
            self._user = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"]
        self._log = open(self.folder / "log", "wb")
        self._options = ["-k", self.folder, "-c", f"listen_addresses={host}",
                         "-c", "max_connections=200", "-c", "shared_buffers=32MB", "-c", "fsync=off"]
        for setting in settings:
            self._options += ["-c", setting]
        self._launch = list(launch)
        self.server = self._client = None
        self.address = f"postgresql://tetstream@/postgres?host={self.folder}"
        try:
            self._make()
            self.start()
        except BaseException:
            self.close()
            raise
        if host:
            self.address = f"postgresql://tetstream@{host}/postgres"

    def _make(self):
        data = self.folder / "data"
        subprocess.run([*self._user, PROGRAMS / "initdb", "-D", data, "-U", "tetstream", "--auth=trust",
                        "--encoding=UTF8", "--locale=C", "--no-sync", "--no-instructions"],
                       check=True, stdout=self._log, stderr=self._log, cwd="/")
        with open(data / "pg_hba.conf", "a", encoding="ascii") as access:
            access.write("host all all samenet trust\n")

    def start(self):
        """On what the disk has. After a kill it waits for what it ran to be gone."""
        deadline = time.monotonic() + GENEROUS_END
        while not self._answers():
            if self.server is None or self.server.poll() is not None:
                self.server = subprocess.Popen(
                    [*self._launch, *self._user, PROGRAMS / "postgres", "-D", self.folder / "data",
                     *self._options], stdout=self._log, stderr=self._log, cwd="/")
            if time.monotonic() > deadline:
                raise AssertionError((self.folder / "log").read_text())
            time.sleep(0.02)

    def _answers(self):
        return self.server is not None and subprocess.run(
            [PROGRAMS / "pg_isready", "-q", "-h", self.folder], check=False).returncode == 0

    def kill(self):
        """kill -9 of the server, which ends all that it runs."""
        self._end(signal.SIGKILL)

    def _end(self, how):
        self._hang_up()
        self.server.send_signal(how)
        self.server.wait()

    def rows(self, query):
        """A query's rows, as lists of text."""
        if self._client is None:
            self._client = subprocess.Popen(
                [PROGRAMS / "psql", "-X", "-A", "-t", "-q", "-F", "\t", "-v", "ON_ERROR_STOP=1",
                 "-d", f"postgresql://tetstream@/postgres?host={self.folder}"],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self._client.stdin.write(f"{query};\n\\echo {END}\n")
        self._client.stdin.flush()
        lines = []
        while (line := self._client.stdout.readline()) != f"{END}\n":
            if not line:
                raise AssertionError("".join(lines))
            lines.append(line)
        return [line.rstrip("\n").split("\t") for line in lines]

    def clear(self):
        """Forgets all: the next store is not the one that its jobs belonged to.

        Tables stay, as making them takes half a second of a processor.
        """
        if self.rows("SELECT to_regclass('schema_version')") != [[""]]:
            self.rows(emptying())

    def _hang_up(self):
        if self._client is not None:
            self._client.communicate()
            self._client = None

    def close(self):
        if self.server is not None:
            # At once, but what is killed leaves its shared memory to the machine.
            self._end(signal.SIGQUIT)
        self._log.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
