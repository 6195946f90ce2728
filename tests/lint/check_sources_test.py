#!/usr/bin/python3
"""check_sources.py on small trees with one error each."""
import pathlib
import tempfile
import unittest

import check_sources


def errors_of(text, file="core/base/a.h"):
    """What check_sources says of a tree with one file."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / file
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
        return check_sources.find_errors(pathlib.Path(folder))


class CheckSources(unittest.TestCase):
    def test_accepts_sentences(self):
        self.assertEqual(errors_of("/// Returns the edges that are cut, none\n/// Of which is short.\n"
                                   "int a;  // of the mesh\n// Assumes b.\n"
                                   "// As a session does, it waits.\n// Nothing is held.\n"), [])

    def test_refuses_a_fragment(self):
        for fragment in ("Of no use.", "The same of b.", "As stored.", "As B::c, but d.", "Nothing where c.", "Likewise."):
            with self.subTest(fragment):
                words = " ".join(fragment.split()[:4])
                self.assertEqual(
                    errors_of(f"int a;\n  /// {fragment}\n"),
                    [f'core/base/a.h:2: a comment begins in a fragment: "{words} ..."'])

    def test_refuses_a_fragment_behind_a_sentence(self):
        self.assertEqual(len(errors_of("/// Returns a.\n/// The same for b.\n")), 1)

    def test_leaves_files_from_elsewhere_alone(self):
        self.assertEqual(errors_of("// As logged.\n", "proto/google/rpc/a.proto"), [])
        self.assertEqual(len(errors_of("// As logged.\n", "proto/tetstream/v1/a.proto")), 1)

    def test_refuses_a_long_file(self):
        long = "int a;\n" * (check_sources.MOST_LINES + 1)
        self.assertEqual(
            errors_of(long),
            ["core/base/a.h: 421 lines, and 420 are the most: does it hold one thing?"])
        self.assertEqual(errors_of(long, "tests/core/base/a.cpp"), [])

    def test_refuses_a_full_folder(self):
        def errors_with(count, room):
            with tempfile.TemporaryDirectory() as root:
                folder = pathlib.Path(root) / room
                (folder / "inner").mkdir(parents=True)
                (folder / "inner" / "a.h").write_text("int a;\n", encoding="utf-8")
                for number in range(count):
                    (folder / f"a{number}.h").write_text("int a;\n", encoding="utf-8")
                return check_sources.find_errors(pathlib.Path(root))

        self.assertEqual(errors_with(check_sources.MOST_FILES, "core/base"), [])
        self.assertEqual(errors_with(check_sources.MOST_FILES + 1, "core/base"),
                         ["core/base: 76 sources, and 75 are the most: part it into rooms"])
        self.assertEqual(errors_with(check_sources.MOST_FILES + 1, "tests/core"), [])

    def test_refuses_a_tree_without_sources(self):
        self.assertEqual(errors_of("", "core/base/a.txt")[0][:20], "there are no sources")


if __name__ == "__main__":
    unittest.main()
