#!/usr/bin/python3
"""Proves that check_startup.py can fail, and does not have to."""
import pathlib
import subprocess
import sys
import unittest

CHECKER = pathlib.Path(__file__).resolve().parent / "check_startup.py"
SMALL, LARGE = "/usr/bin/true", "/bin/bash"


class CheckStartup(unittest.TestCase):
    def check(self, *arguments):
        return subprocess.run([sys.executable, CHECKER, *arguments], capture_output=True, text=True)

    def test_passes_where_only_the_module_loads_the_library(self):
        self.assertEqual(self.check("libtinfo", SMALL, LARGE).returncode, 0)

    def test_fails_where_a_program_loads_it(self):
        done = self.check("libtinfo", SMALL, LARGE, LARGE)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"{LARGE} loads libtinfo", done.stdout)

    def test_fails_where_nothing_loads_it(self):
        self.assertEqual(self.check("libtinfo", SMALL, SMALL).returncode, 1)


if __name__ == "__main__":
    unittest.main()
