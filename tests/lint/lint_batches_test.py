#!/usr/bin/python3
"""Which batches scripts/lint_batches reads, with a compiler and a clang-tidy that are scripts.

    python3 tests/lint/lint_batches_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

LINT_BATCHES = pathlib.Path(__file__).parents[2] / "scripts" / "lint_batches"
# Lists what a batch includes, as clang++ -M does.
COMPILER = r"""#!/bin/bash
echo "$*" | grep -q -- "-M$" || exit 2
for batch; do [[ $batch != *.cxx ]] || break; done
printf 'batch.o: \\\n  %s' "$batch"
sed -n 's/#include "\(.*\)"/\1/p' "$batch" | while read -r file; do
  [[ -e $file ]] || exit 1
  printf ' \\\n  %s' "${file// /\\ }"
done
"""
# Refuses a batch if a file that it includes has the word "slip".
CLANG_TIDY = r"""#!/bin/bash
batch=${!#}
case $3 in
  --version) echo "version $(cat version)"; exit ;;
  --dump-config) cat config; echo "$@"; exit ;;
esac
for option; do [[ $option != --config-file=* ]] || echo "${option#*=}" >>given; done
echo "$(basename "$batch")" >>read
sed -n 's/#include "\(.*\)"/\1/p' "$batch" | tr '\n' '\0' | xargs -0 grep -H slip && exit 1
exit 0
"""


class LintBatches(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("clang++", COMPILER, 0o755)
        self.write("clang-tidy", CLANG_TIDY, 0o755)
        self.write("version", "14")
        self.write("config", "Checks: all")
        self.write("a.cpp", "")
        self.write("b c.cpp", "")
        self.write("shared.h", "")
        self.write("first.cxx", '#include "a.cpp"\n#include "shared.h"\n')
        self.write("second.cxx", '#include "b c.cpp"\n#include "shared.h"\n')
        self.compile_with("-O1")

    def write(self, name, text, mode=0o644):
        (self.root / name).write_text(text, encoding="utf-8")
        (self.root / name).chmod(mode)

    def compile_with(self, flags):
        generated = self.root / "proto" / "generated" / "unity.cxx"
        entries = [{"directory": str(self.root), "file": str(file),
                    "command": f"clang++ {flags} -o {file}.o -c {file}"}
                   for file in (self.root / "first.cxx", self.root / "second.cxx", generated)]
        self.write("compile_commands.json", json.dumps(entries))

    def lint(self, *options, build="."):
        """The batches that were read, and how the script ended."""
        (self.root / "read").unlink(missing_ok=True)
        path = f"{self.root}:{os.environ['PATH']}"
        self.done = subprocess.run([LINT_BATCHES, build, "2", *options], cwd=self.root, text=True,
                                   env={**os.environ, "PATH": path}, capture_output=True, check=False)
        self.assertEqual(self.done.stderr, "")
        read = self.root / "read"
        return sorted(read.read_text().split()) if read.exists() else [], self.done.returncode

    def test_a_clean_batch_is_read_once(self):
        self.assertEqual(self.lint(), (["first.cxx", "second.cxx"], 0))
        self.assertEqual(self.lint(), ([], 0))
        self.assertIn("2 batches of sources: 0 read, and 2 as when they were clean", self.done.stdout)

    def test_a_change_is_read_in_the_batches_that_include_it(self):
        self.lint()
        self.write("b c.cpp", "int b;")
        self.assertEqual(self.lint(), (["second.cxx"], 0))
        self.write("shared.h", "int shared;")
        self.assertEqual(self.lint(), (["first.cxx", "second.cxx"], 0))

    def test_what_is_as_it_was_need_not_be_read_again(self):
        self.lint()
        self.write("a.cpp", "int a;")
        self.lint()
        self.write("a.cpp", "")
        self.assertEqual(self.lint(), ([], 0))

    def test_slips_are_told_until_they_are_mended(self):
        self.write("a.cpp", "slip")
        for _ in range(2):
            read, status = self.lint()
            self.assertEqual(status, 1)
            self.assertIn("first.cxx", read)
            self.assertIn("a.cpp:slip", self.done.stdout)
            self.assertIn(f"not clean: {self.root / 'first.cxx'}", self.done.stdout)
        self.write("a.cpp", "")
        self.assertEqual(self.lint(), (["first.cxx"], 0))

    def test_all_is_read_when_other_things_are_asked(self):
        both = (["first.cxx", "second.cxx"], 0)
        self.lint()
        self.write("config", "Checks: none")
        self.assertEqual(self.lint(), both)
        self.write("version", "15")
        self.assertEqual(self.lint(), both)
        self.assertEqual(self.lint("--checks=-one"), both)
        self.compile_with("-O2")
        self.assertEqual(self.lint("--checks=-one"), both)
        self.assertEqual(self.lint("--checks=-one"), ([], 0))

    def test_sources_are_read_with_what_their_folder_asks_for(self):
        (self.root / "tests" / "core").mkdir(parents=True)
        self.write(".clang-tidy", "of all")
        self.write("tests/.clang-tidy", "of tests")
        unity = self.root / "build" / "tests" / "core" / "unity.cxx"
        unity.parent.mkdir(parents=True)
        self.write("build/tests/core/unity.cxx", "")
        entries = [{"directory": str(self.root), "file": str(file), "command": f"clang++ -o o -c {file}"}
                   for file in (unity, self.root / "first.cxx")]
        self.write("build/compile_commands.json", json.dumps(entries))
        self.assertEqual(self.lint(build="build"), (["first.cxx", "unity.cxx"], 0))
        self.assertEqual((self.root / "given").read_text(), "tests/.clang-tidy\n")

    def test_a_batch_that_does_not_compile_is_never_taken_for_clean(self):
        self.write("first.cxx", '#include "missing.h"\n')
        for _ in range(2):
            read, _ = self.lint()
            self.assertIn("first.cxx", read)


if __name__ == "__main__":
    unittest.main()
