"""Each error that check_notice.py looks for is found.

    python3 tests/lint/check_notice_test.py
"""
import pathlib
import subprocess
import sys
import unittest

from check_notice import find_errors, read_notice

NOTICE = """tetstream

Compiled in: headers

  parser    MIT      parser-dev

Compiled in: archives, of tetstream and tetstream-decoder

  calls     MIT      calls-dev

Linked

  meshes    MPL-2.0  libmeshes1

Loaded by these

  packer    Zlib or MIT  libpacker2
"""


class CheckNotice(unittest.TestCase):
    def errors(self, loaded, built_with=("meshes", "parser"), archived=("calls",)):
        return find_errors(read_notice(NOTICE), set(loaded), set(archived), set(built_with))

    def test_a_notice_of_all_and_no_more_is_fine(self):
        self.assertEqual(self.errors(["meshes", "packer"]), [])

    def test_a_library_is_missing(self):
        self.assertEqual(self.errors(["meshes", "packer", "sockets"]),
                         ["NOTICE lacks sockets, which the programs load"])

    def test_a_library_is_gone(self):
        self.assertEqual(self.errors(["meshes"]), ["NOTICE lists packer, which no program loads"])

    def test_headers_are_missing(self):
        self.assertEqual(self.errors(["meshes", "packer"], ["meshes", "matrices", "googletest"]),
                         ["NOTICE lacks matrices, which the programs are built with"])

    def test_archives_are_missing_or_gone(self):
        self.assertEqual(self.errors(["meshes", "packer"], archived=["calls", "names"]),
                         ["NOTICE lacks the archives of names"])
        self.assertEqual(self.errors(["meshes", "packer"], archived=[]),
                         ["NOTICE lists archives of calls, which nothing contains"])

    def test_programs_were_not_read(self):
        self.assertIn("no program loads any library", self.errors([]))

    def test_without_arguments_it_says_how_it_is_called(self):
        for checker in ("check_notice.py", "check_run_packages.py"):
            run = subprocess.run([sys.executable, "-B", pathlib.Path(__file__).parent / checker],
                                 check=False, capture_output=True, text=True)
            self.assertEqual(run.returncode, 1)
            self.assertRegex(run.stderr, rf"^usage: {checker} .*PROGRAM\.\.\.\n$")


if __name__ == "__main__":
    unittest.main()
