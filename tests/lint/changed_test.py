#!/usr/bin/python3
"""What scripts/lint takes for changed, in clones of a small repository.

    python3 tests/lint/changed_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

CHANGED = pathlib.Path(__file__).parents[2] / "scripts" / "changed.sh"
NAMES = {f"GIT_{who}_{what}": "someone@example.org"
         for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}


class Changed(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.origin = self.root / "origin"
        self.git(self.root, "init", "--quiet", "--initial-branch=main", self.origin)
        self.commit("first", {"a.cpp": "1\n2\n3\n", "b.h": "1\n", "notes.md": "1\n"})

    def run_in(self, folder, *command):
        environment = {**os.environ, **NAMES, "GIT_CONFIG_GLOBAL": "/dev/null"}
        return subprocess.run(command, cwd=folder, env=environment, check=True, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout

    def git(self, folder, *arguments):
        return self.run_in(folder, "git", *arguments).strip()

    def commit(self, subject, files):
        for name, text in files.items():
            (self.origin / name).write_text(text, encoding="utf-8")
        self.git(self.origin, "add", "--all")
        self.git(self.origin, "commit", "--quiet", "--message", subject)

    def clone(self, *options):
        self.git(self.root, "clone", "--quiet", *options, f"file://{self.origin}", "clone")
        return self.root / "clone"

    def ask(self, folder, command):
        """What a function of the script prints, which stops at errors as scripts do."""
        return self.run_in(folder, "bash", "-c", f"set -euo pipefail; source {CHANGED}; {command}")

    def subject_of_base(self, folder):
        base = self.ask(folder, "default_base").strip()
        return self.git(folder, "log", "-1", "--format=%s", base)

    def test_lines_of_cpp_alone_committed_or_not(self):
        self.commit("second", {"a.cpp": "1\ntwo\n3\n4\n5\n", "notes.md": "2\n"})
        (self.origin / "b.h").write_text("0\n1\n", encoding="utf-8")
        (self.origin / "new.cpp").write_text("1\n2\n", encoding="utf-8")
        lines = self.ask(self.origin, "changed_lines HEAD^1").splitlines()
        self.assertEqual(sorted(lines), ["a.cpp 2 2", "a.cpp 4 5", "b.h 1 1", "new.cpp 1 2"])
        shown = json.loads(self.ask(self.origin, "changed_lines HEAD^1 | line_filter"))
        self.assertEqual({entry["name"]: entry["lines"] for entry in shown},
                         {"a.cpp": [[2, 2], [4, 5]], "b.h": [[1, 1]], "new.cpp": [[1, 2]]})

    def test_nothing_where_lines_only_went_or_moved_with_their_file(self):
        self.git(self.origin, "mv", "a.cpp", "moved.cpp")
        self.commit("second", {"b.h": ""})
        self.assertEqual(self.ask(self.origin, "changed_lines HEAD^1"), "")

    def test_of_a_branch_since_it_left_its_upstream(self):
        clone = self.clone()
        for subject in ("second", "third"):
            self.git(clone, "commit", "--quiet", "--allow-empty", "--message", subject)
        self.assertEqual(self.subject_of_base(clone), "first")

    def test_of_the_upstream_branch_since_the_last_landing(self):
        self.commit("second", {"a.cpp": "1\n"})
        self.commit("third", {"a.cpp": "2\n"})
        self.assertEqual(self.subject_of_base(self.clone()), "second")

    def test_of_a_shallow_clone_too(self):
        self.commit("second", {"a.cpp": "1\n"})
        self.commit("third", {"a.cpp": "2\n"})
        self.assertEqual(self.subject_of_base(self.clone("--depth=1")), "second")

    def test_of_a_shallow_clone_without_its_origin_nothing_can_be_said(self):
        self.commit("second", {"a.cpp": "1\n"})
        clone = self.clone("--depth=1")
        self.git(clone, "remote", "set-url", "origin", "file:///nowhere")
        self.assertEqual(self.ask(clone, "default_base || echo none").strip(), "none")


if __name__ == "__main__":
    unittest.main()
