#!/usr/bin/python3
"""Shows that compare.py tells faster from slower, and fails when it is asked to."""
import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import compare


def run_of(name, milliseconds, **more):
    return {"name": name, "run_type": "iteration", "real_time": milliseconds,
            "cpu_time": 2 * milliseconds, "time_unit": "ms", **more}


class Compare(unittest.TestCase):

    def compare(self, before, after, *options):
        """(exit code or message, what was printed)"""
        with tempfile.TemporaryDirectory() as folder:
            paths = [pathlib.Path(folder, name) for name in ("before.json", "after.json")]
            for path, runs in zip(paths, (before, after)):
                path.write_text(json.dumps({"benchmarks": runs}), encoding="utf-8")
            printed = io.StringIO()
            with mock.patch.object(sys, "argv", ["compare.py", *map(str, paths), *options]), \
                    contextlib.redirect_stdout(printed):
                try:
                    compare.main()
                except SystemExit as stop:
                    return stop.code, printed.getvalue()
        return 0, printed.getvalue()

    def test_passes_when_nothing_is_slower_than_allowed(self):
        code, text = self.compare([run_of("mesh", 100)], [run_of("mesh", 109)],
                                  "--slower", "1.10")
        self.assertEqual(code, 0)
        self.assertIn("1.090", text)

    def test_fails_when_one_benchmark_is_slower_though_the_mean_is_not(self):
        code, _ = self.compare([run_of("a", 100), run_of("b", 100)],
                               [run_of("a", 111), run_of("b", 10)], "--slower", "1.10")
        self.assertIn("1 of 2", code)

    def test_never_fails_unless_asked_to(self):
        code, text = self.compare([run_of("a", 1)], [run_of("a", 9)])
        self.assertEqual(code, 0)
        self.assertIn("9.000", text)

    def test_compares_medians_of_repeated_runs_and_leaves_aggregates_out(self):
        before = [run_of("a", 10), run_of("a", 20), run_of("a", 900)]
        aggregate = run_of("a", 5000, run_type="aggregate")
        _, text = self.compare(before, [run_of("a", 30), aggregate])
        self.assertIn("1.500", text)

    def test_understands_different_units(self):
        after = run_of("a", 4_000_000, time_unit="ns")
        _, text = self.compare([run_of("a", 2)], [after])
        self.assertIn("2.000", text)

    def test_says_which_benchmarks_are_in_one_file_only(self):
        _, text = self.compare([run_of("a", 1), run_of("old", 1)], [run_of("a", 1)])
        self.assertRegex(text, r"old +only in BEFORE")

    def test_refuses_files_without_a_common_benchmark(self):
        code, _ = self.compare([run_of("a", 1)], [run_of("b", 1)])
        self.assertIn("no benchmark", code)


if __name__ == "__main__":
    unittest.main()
