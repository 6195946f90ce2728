#!/usr/bin/python3
"""check_reasons.py on small trees that lack one thing each."""
import pathlib
import tempfile
import unittest

import check_reasons


def errors_of(source, listed, told, file="server/a.cpp"):
    """What check_reasons says of a server whose source is `source`."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for path, text in (
                (file, source),
                ("proto/convert/reasons.h", "".join(f'"{name}",\n' for name in listed)),
                ("docs/errors.md", "".join(f"| `{name}` | X |\n" for name in told))):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")
        return check_reasons.find_errors(root)


class CheckReasons(unittest.TestCase):
    def test_accepts_reasons_that_are_known_everywhere(self):
        self.assertEqual(errors_of('with_reason(s, "DISK"); "TETSTREAM_X"', ["DISK"], ["DISK"]), [])
        self.assertEqual(errors_of("", ["INTERNAL"], ["INTERNAL"]), [])

    def test_finds_a_reason_that_is_not_listed(self):
        self.assertEqual(errors_of('return "NEW_REASON";', [], []),
                         ["server/a.cpp: NEW_REASON is not in proto/convert/reasons.h"])

    def test_looks_into_every_folder_of_the_server(self):
        self.assertEqual(errors_of('return "NEW_REASON";', [], [], "server/jobs/a.cpp"),
                         ["server/jobs/a.cpp: NEW_REASON is not in proto/convert/reasons.h"])

    def test_finds_a_reason_that_nothing_uses(self):
        self.assertEqual(errors_of("", ["GONE"], ["GONE"]),
                         ["proto/convert/reasons.h: no source uses GONE"])

    def test_finds_a_reason_that_is_not_told(self):
        self.assertEqual(errors_of('"DISK"', ["DISK"], []), ["docs/errors.md: lacks DISK"])
        self.assertEqual(errors_of("", [], ["GONE"]),
                         ["docs/errors.md: GONE is not in proto/convert/reasons.h"])

    def test_finds_a_list_out_of_order(self):
        self.assertEqual(errors_of('"DISK" "BUSY"', ["DISK", "BUSY"], ["BUSY", "DISK"]),
                         ["proto/convert/reasons.h: not in the order of the alphabet"])


if __name__ == "__main__":
    unittest.main()
