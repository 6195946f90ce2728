#!/usr/bin/python3
"""check_docs.py on small trees with one error each."""
import pathlib
import tempfile
import unittest

import check_docs


def errors_of(text, others=None):
    """What check_docs says of a README.md with this text, beside docs/page.md and other files."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "docs").mkdir()
        (root / "docs/page.md").write_text("# A page\n\n## It's here\n", encoding="utf-8")
        for path, content in {"README.md": text, **(others or {})}.items():
            (root / path).write_text(content, encoding="utf-8")
        return check_docs.find_errors(root)


class CheckDocs(unittest.TestCase):
    def test_accepts_links_that_lead_somewhere(self):
        self.assertEqual(errors_of("# Top\n[a](docs/page.md) [b](docs/page.md#its-here) "
                                   "[c](#top) [d](https://example.org/x)\n"), [])

    def test_refuses_a_missing_file_and_a_missing_picture(self):
        self.assertEqual(errors_of("[a](docs/nope.md)"),
                         ["README.md: docs/nope.md leads nowhere"])
        self.assertEqual(len(errors_of("![a](docs/nope.png)")), 1)

    def test_refuses_a_missing_heading(self):
        self.assertEqual(errors_of("[a](docs/page.md#gone)"),
                         ["README.md: docs/page.md#gone: no such heading"])

    def test_leaves_code_alone(self):
        self.assertEqual(errors_of("`[a](nope)`\n\n```\n[a](nope)\n```\n"), [])

    def test_refuses_what_is_left_to_be_filled_in(self):
        self.assertEqual(errors_of("```python\nif a:\n    XX\n```\n"),
                         ["README.md: line 3: XX is left to be filled in"])
        self.assertEqual(errors_of("TETSTREAM_XX, XXL\n"), [])

    def test_refuses_a_path_that_is_not_there(self):
        self.assertEqual(errors_of("`docs/page.md`, `docs/gone.md`, `docs/NAME/a`, docs/gone.md"),
                         ["README.md: there is no docs/gone.md"])
        self.assertEqual(errors_of("", {"CHANGELOG.md": "`docs/gone.md` is gone"}), [])

    def test_refuses_a_test_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "tests").mkdir()
            (root / "tests/a_test.cpp").write_text("TEST(Store, Lives) {}\nTEST_F(Disk,\n       Fills) {}\n")
            (root / "tests/a_test.py").write_text("class Farm(Case):\n    def test_it(self):\n        pass\n")
            page = root / "README.md"
            page.write_text("`tests/a_test.cpp` (`Store.Lives`, `Disk.Fills`, `Farm.test_it`)\n`Any.Thing`\n")
            self.assertEqual(check_docs.find_errors(root), [])
            page.write_text("`tests/a_test.py`: `Store.Dies`, `Farm.test_that`\n")
            self.assertEqual(check_docs.find_errors(root), [
                "README.md: there is no test Store.Dies", "README.md: there is no test Farm.test_that"])

    def test_refuses_an_index_that_lacks_a_page(self):
        self.assertEqual(errors_of("", {"docs/README.md": "[a](page.md#its-here)"}), [])
        self.assertEqual(errors_of("", {"docs/README.md": "page.md"}),
                         ["docs/README.md: page.md is not listed"])

    def test_refuses_a_changelog_out_of_order(self):
        def errors(*titles):
            text = "# Changelog\n" + "".join(f"\n## {title}\n" for title in titles)
            return errors_of("", {"CHANGELOG.md": text})
        self.assertEqual(errors("0.10.0 (unreleased)", "0.2.0 (2026-02-01)", "0.1.9 (2026-02-01)"), [])
        self.assertEqual(errors("Unreleased"), [
            'CHANGELOG.md: "Unreleased" is not "1.2.3 (2026-01-31)" or "1.2.3 (unreleased)"'])
        for late in ("0.3.0 (2026-01-01)", "0.1.0 (2026-03-01)", "0.1.0 (unreleased)",
                     "0.2.0 (2026-02-01)"):
            with self.subTest(late):
                self.assertEqual(errors("0.2.0 (2026-02-01)", late),
                                 [f"CHANGELOG.md: {late} stands below an older version or date"])


if __name__ == "__main__":
    unittest.main()
