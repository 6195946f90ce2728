#!/usr/bin/python3
"""Proves that check_names.py can fail, and does not have to."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECKER = pathlib.Path(__file__).resolve().parent / "check_names.py"


def of(text, space="tet"):
    return f"namespace {space} {{\n{text}\n}}  // namespace {space}\n"


class CheckNames(unittest.TestCase):
    def check(self, **files):
        with tempfile.TemporaryDirectory() as root:
            for name, text in files.items():
                folder, stem = name.split("_")
                path = pathlib.Path(root, folder, f"{stem}.h")
                path.parent.mkdir(exist_ok=True)
                path.write_text(text, encoding="utf-8")
            subprocess.run(["git", "init", "-q", root], check=True)
            subprocess.run(["git", "-C", root, "add", "."], check=True)
            return subprocess.run([sys.executable, CHECKER, root], capture_output=True, text=True)

    def test_fails_where_two_types_share_a_name(self):
        for one in ("struct Face {\n};", "class Face final : public Shape {\n};",
                    "enum class Face : int { kOne };"):
            done = self.check(a_face=of("struct Face {\n};"), b_face=of(one))
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stdout, r"tet::Face is defined in .*/a/face.h and in .*/b/face.h")

    def test_fails_where_two_inline_functions_share_name_and_parameters(self):
        done = self.check(a_x=of("constexpr int edge(int a, int b) noexcept {\n}"),
                          b_y=of("inline int edge(int i, int j) {\n}"))
        self.assertIn("tet::edge(int, int) is defined in", done.stdout)

    def test_passes_what_the_linker_tells_apart(self):
        done = self.check(
            a_x=of("struct Face {\n};\nstruct Impl;\nconstexpr int edge(int a) {\n}"),
            b_y=of("struct Face {\n};\n", "tet::test") + of("inline int edge(double a) {\n}"),
            c_z=of("namespace {\nstruct Face {\n};\n}  // namespace\nstruct Impl;\n"
                   "struct Face::Part {\n};"))
        self.assertEqual((done.returncode, done.stdout), (0, "no two definitions share a name\n"))


if __name__ == "__main__":
    unittest.main()
