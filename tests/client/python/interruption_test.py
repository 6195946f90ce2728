"""Ctrl-C while the library works, in programs of their own."""

import subprocess
import sys

import pytest

import running_server

# A thread of the program asks for a signal once the mesher has used a processor for a while. It can do so
# only while the main thread, which meshes, lets other threads of Python run.
PROGRAM = """
import os, signal, sys, threading, time
sys.path.insert(0, {tests!r})
from conftest import make_ball
import tetstream as ts

def interrupt():
    begin = time.process_time()
    while time.process_time() < begin + 0.1:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever whoever started this does with it
client, ball = ts.Client({address!r}, attempts=1), make_ball(40)
{first}
threading.Thread(target=interrupt, daemon=True).start()
try:
    {call}
except KeyboardInterrupt:
    print("interrupted")
    client.mesh(make_ball(4))
    print("and well")
"""
LONG = "spacing=0.002"  # minutes


def said_by(call, first="", address=":local:"):
    import conftest
    program = PROGRAM.format(tests=str(conftest.ROOT / "tests/client/python"), address=address, first=first, call=call)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False,
                          timeout=running_server.GENEROUS_END)
    assert done.returncode == 0, done.stderr
    return done.stdout.split("\n")


@pytest.mark.parametrize("name", ["mesh", "estimate", "stream"])
def test_stops_the_work_and_raises(name):
    assert said_by(f"client.{name}(ball, {LONG})")[:2] == ["interrupted", "and well"]


def test_stops_between_chunks():
    said = said_by("for chunk in stream: pass", first="stream = client.stream(ball, spacing=0.006, levels=0)")
    assert said[:2] == ["interrupted", "and well"]


def test_stops_what_a_server_does(server):
    said = said_by("for chunk in stream: time.sleep(0.001)", address=server.address,
                   first="stream = client.stream(ball, spacing=0.008, levels=0)")
    assert said[:2] == ["interrupted", "and well"]
    running_server.wait_until(lambda: server.samples()["tetstream_meshes_running"] == 0)


FIRST_CALLS = """
import threading
import tetstream as ts

def ask():
    raise AssertionError("a call runs Python to learn which thread it is on")

threading.main_thread = ask
other = threading.Thread(target=ts.estimate, args=[ts.sphere(1)])
other.start()
ts.estimate(ts.sphere(1))
other.join()
print("done")
"""


def test_the_first_calls_of_two_threads_do_not_wait_for_each_other():
    """None holds the GIL while it waits for another that needs it to learn which thread handles signals."""
    done = subprocess.run([sys.executable, "-c", FIRST_CALLS], capture_output=True, text=True, check=False,
                          timeout=running_server.GENEROUS_END)
    assert (done.stdout, done.stderr) == ("done\n", "")
