#!/usr/bin/python3
"""check_docs.py on small trees with one broken link each."""
import pathlib
import tempfile
import unittest

import check_docs


def errors_of(text):
    """What check_docs says of a README.md with this text, beside docs/page.md."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "docs").mkdir()
        (root / "docs/page.md").write_text("# A page\n\n## It's here\n", encoding="utf-8")
        (root / "README.md").write_text(text, encoding="utf-8")
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


if __name__ == "__main__":
    unittest.main()
