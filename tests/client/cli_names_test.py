"""Names that would act on a terminal, as the tetstream command shows them: nothing of others
reaches it but printable characters, and JSON has them exactly.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_names_test.py [unittest options]
"""

import json
import struct
import unicodedata
import unittest

from command_case import DONE, REFUSED, CommandTest
from job_case import JobTest

# What is in the place of the fixture's names, of as many bytes, and how it is shown.
HOSTILE = {
    b"ball": (b"\x1b[2J", r"\x1b[2J"),  # clears the screen
    b"ring": (b"\x7f\n\tx", r"\x7f\n\tx"),  # another line
    b"cloud": (b"\xc2\x9b2J\r", r"\u009b2J\r"),  # so does this; back to where the line begins
    b"twin": (b"\xe2\x80\xaeg", r"\u202eg"),  # from right to left
}
JOB_NAME = "\x1b]0;title\x07\nfake line\r\u202e\u2066\u009b31m\x7f größe 兎"
SHOWN_JOB_NAME = r"\x1b]0;title\x07\nfake line\r\u202e\u2066\u009b31m\x7f größe 兎"


def acting(text):
    """The characters that are not for showing, but for a line's end."""
    return {character for character in text
            if character != "\n" and unicodedata.category(character) in ("Cc", "Cf", "Zl", "Zp")}


def with_names(content, names):
    """A file's bytes with other names of its grids, each as long as the one before."""
    for name, other in names.items():
        assert len(name) == len(other)
        length = struct.pack("<I", len(name))  # which tells a name from a part of another text
        content = content.replace(length + name, length + other)
    return content


class Names(CommandTest):
    volumes = {"parts": 0.2}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        path = cls.inputs / "parts.vdb"
        names = {name: hostile for name, (hostile, _) in HOSTILE.items()}
        path.write_bytes(with_names(path.read_bytes(), names))

    def assert_shown(self, result, *words):
        self.assertEqual(acting(result.stdout + result.stderr), set())
        for word in words:
            self.assertIn(word, result.stdout + result.stderr)

    def test_are_escaped_in_the_list_of_grids(self):
        result = self.tetstream("info", self.inputs / "parts.vdb")
        self.assert_done(result)
        self.assert_shown(result, *(shown for _, shown in HOSTILE.values()))
        names = json.loads(self.tetstream("info", self.inputs / "parts.vdb", "--json").stdout)
        self.assertEqual(len(result.stdout.splitlines()), 1 + len(names))

    def test_are_exact_in_json_that_a_terminal_may_show(self):
        result = self.tetstream("info", self.inputs / "parts.vdb", "--json")
        self.assert_done(result)
        self.assertTrue(result.stdout.isascii())
        self.assert_shown(result)
        names = [grid["name"] for grid in json.loads(result.stdout)]
        for hostile, _ in HOSTILE.values():
            self.assertIn(hostile.decode(), names)

    def test_are_escaped_in_a_summary_and_exact_in_its_report(self):
        report = self.out / "report.json"
        result = self.mesh("parts.vdb", ".vtu", "--all-grids", "--report", report)
        self.assert_done(result)
        self.assert_shown(result, *(shown for _, shown in HOSTILE.values()))
        parts = [part["name"] for part in json.loads(report.read_text("ascii"))["parts"]]
        self.assertEqual(parts, [hostile.decode() for hostile, _ in HOSTILE.values()])

    def test_are_escaped_in_errors(self):
        result = self.mesh("parts.vdb", ".vtu", "--grid", "\x1b[31mnone\n")
        self.assertEqual(result.returncode, REFUSED)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assert_shown(result, "?[31mnone?", "?[2J")  # as decoders say it
        other = self.out / "other.vdb"
        content = (self.inputs / "parts.vdb").read_bytes()
        other.write_bytes(with_names(content, {HOSTILE[b"ball"][0]: b"\x9b2J\n"}))
        result = self.tetstream("info", other)  # C1 in one byte, which is no UTF-8 but Latin-1
        self.assert_done(result)
        self.assert_shown(result, r"\u009b2J\n")
        result = self.tetstream("info", self.inputs / "\x1b[2J\n.vdb")
        self.assertEqual(result.returncode, REFUSED)
        self.assert_shown(result, r"\x1b[2J\n.vdb")


class NamesOfJobs(JobTest):
    def test_are_escaped_and_exact_in_json(self):
        path = self.inputs / "sphere.vdb"
        [name] = self.submit(path, "--name", JOB_NAME, "--priority", "1")
        for command in (("wait", name), ("list",), ("show", name), ("list", "--name", "\x1b")):
            result = self.job(*command)
            self.assertEqual(result.returncode, DONE, result.stderr)
            self.assertEqual(acting(result.stdout + result.stderr), set(), command)
            self.assertIn(SHOWN_JOB_NAME, result.stdout, command)
            self.assertNotIn("\nfake line", result.stdout)
            result = self.job(*command, "--json")
            self.assertTrue(result.stdout.isascii(), command)
            [job] = self.objects(result)
            self.assertEqual(job["display_name"], JOB_NAME, command)

    def test_are_escaped_where_they_are_refused(self):
        result = self.job("show", "\x1b[2J\n\u202e")
        self.assertEqual(result.returncode, REFUSED)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertEqual(acting(result.stdout + result.stderr), set())

    def test_times_beyond_all_are_refused_with_the_limit(self):
        for option in ("--ttl", "--timeout"):
            result = self.job("submit", self.inputs / "sphere.vdb", option, "87660000h")
            self.assertEqual(result.returncode, REFUSED, result.stderr)
            self.assertIn("a hundred years: leave it out", result.stderr)
        for moment in ("inf", "-inf", "2562047788015215h", "9999999h"):
            result = self.job("list", "--since", moment)
            self.assertIn(result.returncode, (DONE, REFUSED), moment)
        self.assertIn("years 1 to 9999", self.job("list", "--since", "inf").stderr)
        [name] = self.submit(self.inputs / "sphere.vdb")
        for patience in ("2562047h", "99999999999h", "inf"):  # of centuries: not over at once
            self.assert_done(self.job("wait", name, "--patience", patience))


if __name__ == "__main__":
    unittest.main()
