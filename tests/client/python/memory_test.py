"""What memory the package takes: no more than a mesh does, and nothing that stays."""

import subprocess
import sys

from conftest import ROOT

# Many small meshes, and everything that is made of one.
SMALL = """
import gc, sys
sys.path.insert(0, {tests!r})
from conftest import make_ball
import tetstream as ts

def resident():
    gc.collect()
    return int(open("/proc/self/statm").read().split()[1]) * 4096

client, ball = ts.Client({address!r}), make_ball(3)
def work(count):
    for i in range(count):
        mesh = client.mesh(ball, faces=True, fields=None)
        mesh.points, mesh.fields, mesh.statistics, mesh.header
        if i % 100 == 0:
            list(client.stream(ball))
            ts.mesh(ts.sphere(1) | ts.box(1), spacing=0.5)
            try:
                ts.mesh(ts.sphere(-1))
            except ts.Error:
                pass
work({count} // 5)
before = resident()
work({count})
print(resident() - before)
"""

LARGE = """
import resource, sys
sys.path.insert(0, {tests!r})
import tetstream as ts

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

client = ts.Client({address!r})
solid = ts.sphere(1)
client.mesh(solid, spacing=0.1)
before = peak()
mesh = client.mesh(solid, spacing=0.0135, levels=0, statistics=False)
size = mesh.local_points.nbytes + mesh.tets.nbytes
print(size, peak() - before)
"""


def said_by(program, **given):
    text = program.format(tests=str(ROOT / "tests/client/python"), **given)
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return list(map(int, done.stdout.split()))


def test_many_small_meshes_leave_nothing_behind(server, pytestconfig):
    grown, = said_by(SMALL, address=server.address, count=pytestconfig.getoption("meshes"))
    print(f"resident memory grew by {grown / 2**20:.1f} MiB")
    assert grown < 16 << 20  # a reference that leaked would keep a mesh of 20 kB, a thousand times


def test_a_mesh_that_is_received_takes_little_more_than_itself(server):
    size, taken = said_by(LARGE, address=server.address)
    assert size > 100 << 20
    assert taken < 1.3 * size
