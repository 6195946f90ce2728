"""Manual pages have what --help has, troff takes them, and shells complete what they say.

    TETSTREAM_BIN=build/release/bin python3 tests/core/manual/manual_test.py [unittest options]
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))

from waiting import GENEROUS_END  # noqa: E402

SECTIONS = {"tetstream": "1", "tetstream-load": "1", "tetstreamd": "8"}
BIN = pathlib.Path(os.environ["TETSTREAM_BIN"]).resolve()


def run(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True,
                          timeout=GENEROUS_END, check=False, **options)


class ManualTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        for program in SECTIONS:
            written = run(BIN / program, "--write-manual", cls.folder,
                          env={"TETSTREAM_MANUAL_DATE": "2026-01-31"})
            assert (written.returncode, written.stdout, written.stderr) == (0, "", "")


def commands_of(program, *words):
    """The program and each of its commands as words, by what --help lists of them."""
    yield (program, *words)
    text = run(BIN / program, *words, "--help").stdout
    listed = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.MULTILINE)
    for name in re.findall(r"^  (\S+)", listed[1], re.MULTILINE) if listed else ():
        yield from commands_of(program, *words, name)


def options_in_help(command):
    text = run(BIN / command[0], *command[1:], "--help").stdout
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.MULTILINE))


class Help(unittest.TestCase):
    def test_of_a_worker_lists_the_settings_that_concern_it_and_no_others(self):
        worker, server = options_in_help(("tetstreamd", "worker")), options_in_help(("tetstreamd",))
        self.assertLessEqual(worker, server | {"--help"})
        self.assertLessEqual({"--store", "--jobs", "--job-workers", "--job-lease-seconds", "--threads",
                              "--result-bytes", "--max-tets", "--metrics-listen"}, worker)
        self.assertFalse({"--listen", "--max-streams", "--tokens", "--tls-cert"} & worker)
        self.assertLessEqual({"--listen", "--max-streams"}, server)


class Pages(ManualTest):
    def page_of(self, command):
        return self.folder / "man" / f"{'-'.join(command)}.{SECTIONS[command[0]]}"

    def each_page(self):
        for program in SECTIONS:
            for command in commands_of(program):
                yield command, self.page_of(command)

    def test_each_command_has_a_page_with_every_option_of_its_help(self):
        pages = set()
        for command, page in self.each_page():
            pages.add(page)
            rendered = run("groff", "-man", "-Tascii", "-P-cbou", "-rHY=0", "-rLL=200n", page).stdout
            described = set(re.findall(r"^ {7}(?:-\w, )?(--[\w-]+)", rendered, re.MULTILINE))
            self.assertEqual(described, options_in_help(command), page.name)
            self.assertTrue(described)
        self.assertEqual(pages, set((self.folder / "man").iterdir()))
        self.assertGreater(len(pages), 15)

    def test_a_page_says_what_else_the_help_says(self):
        text = run("groff", "-man", "-Tascii", "-P-cbou", "-rHY=0", "-rLL=200n",
                   self.page_of(("tetstream", "mesh"))).stdout
        for said in ("tetstream mesh [OPTIONS] INPUT", "One of default, min-angle, both-sides.",
                     "Not with --skip-statistics.", "Environment: TETSTREAM_TOKEN_FILE.",
                     "tetstream mesh bunny.vdb -o bunny.msh --levels 0\n", "2026-01-31"):
            self.assertIn(said, text)

    def test_troff_and_mandoc_find_no_fault(self):
        for _, page in self.each_page():
            groff = run("groff", "-man", "-Tutf8", "-ww", page)
            self.assertEqual((groff.returncode, groff.stderr), (0, ""))
            linted = run("mandoc", "-Tlint", "-Wwarning", page)
            self.assertEqual((linted.returncode, linted.stdout), (0, ""))

    def test_pages_lead_to_pages(self):
        for _, page in self.each_page():
            text = page.read_text().partition(".SH SEE ALSO\n")[2].replace("\\-", "-")
            for name, section in re.findall(r"\\fB(\S+?)\\fR\((\d)\)", text):
                self.assertTrue((page.parent / f"{name}.{section}").exists(), name)

    def test_a_folder_that_cannot_be_made_is_told(self):
        written = run(BIN / "tetstream", "--write-manual", "/dev/null/manual")
        self.assertNotEqual(written.returncode, 0)
        self.assertIn("/dev/null/manual", written.stderr)


class Completions(ManualTest):
    def bash(self, line, program="tetstream"):
        """What bash would offer behind this line, by the function that it would call."""
        words = line.split(" ")
        quoted = " ".join(f"'{word}'" for word in words)
        script = (f"source {self.folder}/bash/{program}; compopt() {{ :; }}\n"
                  f"COMP_WORDS=({quoted}) COMP_CWORD={len(words) - 1} COMP_LINE='{line}'\n"
                  f"read -ra call <<< \"$(complete -p {program})\"\n"
                  "\"${call[-2]}\"; printf '%s\\n' \"${COMPREPLY[@]}\"")
        offered = run("bash", "--norc", "-c", script, cwd=self.folder)
        self.assertEqual((offered.returncode, offered.stderr), (0, ""))
        return offered.stdout.split()

    def fish(self, line):
        offered = run("fish", "--no-config", "--command",
                      f"source {self.folder}/fish/tetstream.fish; complete --do-complete '{line}'",
                      cwd=self.folder, env={"HOME": str(self.folder), "PATH": os.environ["PATH"]})
        self.assertEqual((offered.returncode, offered.stderr), (0, ""))
        return [line.split("\t")[0] for line in offered.stdout.splitlines()]

    def test_bash_completes_a_command(self):
        self.assertEqual(self.bash("tetstream es"), ["estimate"])
        self.assertEqual(self.bash("tetstream job wa"), ["watch", "wait"])

    def test_bash_completes_an_option_of_the_command(self):
        self.assertEqual(self.bash("tetstream mesh --pre"), ["--preset"])
        self.assertEqual(self.bash("tetstream info --pre"), [])
        self.assertEqual(self.bash("tetstream job submit a.vdb --man"), ["--manifest", "--manifold"])

    def test_bash_completes_a_value(self):
        self.assertEqual(self.bash("tetstream mesh --preset b"), ["both-sides"])
        self.assertEqual(self.bash("tetstream mesh --preset = b"), ["both-sides"])
        self.assertEqual(self.bash("tetstream mesh --format in"), ["inp"])
        self.assertEqual(self.bash("tetstream job fetch --format pol"), ["polymesh"])
        (self.folder / "scan.vdb").touch()
        self.assertEqual(self.bash("tetstream mesh sc"), ["scan.vdb"])
        self.assertEqual(self.bash("tetstream mesh --sizing-grid sc"), ["scan.vdb"])
        self.assertEqual(self.bash("tetstream mesh --iso "), [])

    def test_bash_completes_the_other_programs(self):
        self.assertEqual(self.bash("tetstreamd --store-b", "tetstreamd"), ["--store-bytes"])
        self.assertEqual(self.bash("tetstreamd worker --job-w", "tetstreamd"), ["--job-workers"])
        self.assertEqual(self.bash("tetstream-load --ra", "tetstream-load"), ["--rate"])

    def test_fish_completes_as_bash_does(self):
        for line, offered in {"tetstream es": ["estimate"], "tetstream job wai": ["wait"],
                              "tetstream mesh --pre": ["--preset"],
                              "tetstream mesh --preset b": ["both-sides"]}.items():
            self.assertEqual(self.fish(line), offered, line)

    def test_zsh_takes_the_scripts(self):
        for program in SECTIONS:
            taken = run("zsh", "--no-rcs", "-n", self.folder / "zsh" / f"_{program}")
            self.assertEqual((taken.returncode, taken.stderr), (0, ""))

    def test_a_real_bash_loads_and_completes_on_the_tab_key(self):
        """Typed at a terminal, with readline between."""
        typed = f"source {self.folder}/bash/tetstream\ntetstream estim\t\x01echo \x05\nexit\n"
        shell = run("script", "--quiet", "--command", "bash --norc --noprofile", "/dev/null",
                    input=typed, env={"PATH": os.environ["PATH"], "TERM": "dumb", "PS1": "$ "})
        self.assertIn("\ntetstream estimate", shell.stdout.replace("\r", ""))


if __name__ == "__main__":
    unittest.main(verbosity=2)
