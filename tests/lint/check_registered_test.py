"""check_registered.py finds parts of tests that nobody runs."""

import pathlib
import tempfile
import unittest

import check_registered


class CheckRegistered(unittest.TestCase):
    def errors(self, lists, **scripts):
        with tempfile.TemporaryDirectory() as folder:
            tests = pathlib.Path(folder) / "tests"
            tests.mkdir()
            (tests / "CMakeLists.txt").write_text(lists)
            for name, text in scripts.items():
                (tests / name.replace("_dot_", ".")).write_text(text)
            return check_registered.find_errors(pathlib.Path(folder))

    def test_finds_a_class_that_is_not_named(self):
        text = "class Named:\n  def test_a(self): pass\nclass Forgotten:\n  def test_b(self): pass\n"
        [error] = self.errors('tet_cli_tests(a_test.py "slow;service" Named)', a_test_dot_py=text)
        self.assertIn("Forgotten", error)
        self.assertEqual(self.errors("tet_cli_tests(a_test.py slow Named)\ntet_cli_tests(a_test.py slow\n  Forgotten)",
                                     a_test_dot_py=text), [])

    def test_finds_a_class_whose_tests_are_those_of_another(self):
        text = "class Four:\n  def test_a(self): pass\nclass Six(Four):\n  listen = 6\n"
        self.assertEqual(len(self.errors("tet_cli_tests(a_test.py slow Four)", a_test_dot_py=text)), 1)

    def test_passes_over_classes_without_tests(self):
        text = "class Case:\n  def helps(self): pass\nclass Named(Case):\n  def test_a(self): pass\n"
        self.assertEqual(self.errors("tet_cli_tests(a_test.py slow Named)", a_test_dot_py=text), [])

    def test_finds_a_part_of_the_page(self):
        text = 'part("Meshes", () => {\n});\npart("Cuts", () => {\n});\n'
        [error] = self.errors("page_test(page_test.mjs Meshes)", page_test_dot_mjs=text)
        self.assertIn("Cuts", error)


if __name__ == "__main__":
    unittest.main()
