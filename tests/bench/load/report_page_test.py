"""The page that compares runs of tetstream-load, of runs against a real server.

    TETSTREAM_BIN=build/dev/bin python3 tests/bench/load/report_page_test.py [unittest options]
"""

import html.parser
import json
import pathlib
import subprocess
import sys
import unittest

from load_cli_test import GENEROUS_END, OnAServer

SCRIPT = pathlib.Path(__file__).parents[3] / "bench" / "load" / "report_page.py"


def render(*arguments):
    return subprocess.run([sys.executable, "-B", SCRIPT, *map(str, arguments)],
                          capture_output=True, text=True, timeout=GENEROUS_END, check=False)


class Page(html.parser.HTMLParser):
    """What is on a page: its elements in order, and the text of each kind."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.texts, self.open = [], {}, []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if self.open:
            self.texts.setdefault(self.open[-1], []).append(data)

    def count(self, tag):
        return sum(1 for name, _ in self.elements if name == tag)


class ReportPage(OnAServer):
    volumes = {"sphere": 0.1}

    def run_load(self, name, *arguments, seconds):
        """The report of a run in which something was answered."""
        _, _, report = self.load_until(lambda report: report["requests"]["done"] > 0, "--warm-up", "0", "--quiet",
                                       *arguments, seconds=seconds, report=name)
        return report

    def test_compares_runs_by_the_figures_they_measured(self):
        steps = self.run_load("a.json", "--rate", "20,40", seconds=0.5)
        workers = self.run_load("b.json", "--workers", "2", "--target", "p99=900s", seconds=0.4)
        result = render(self.out / "a.json", f"callers={self.out / 'b.json'}",
                        "-o", self.out / "page.html")
        self.assert_done(result)
        text = (self.out / "page.html").read_text()
        page = Page(text)
        self.assertEqual(page.open, [])

        figures = json.loads("".join(page.texts["script"]))
        self.assertEqual([run["name"] for run in figures], ["a", "callers"])
        for run, measured in zip(figures, (steps, workers)):
            for key in ("rates", "requests", "errors", "latency_ms"):
                self.assertEqual(run[key], measured[key])

        cells = page.texts["td"]
        self.assertIn(str(steps["requests"]["offered"]), cells)
        self.assertIn(f"{workers['latency_ms']['first_chunk']['p99']:.4g}", cells)
        told = " ".join(page.texts["title"])
        self.assertIn(f"a: {steps['latency_ms']['whole']['p50']:.4g} ms", told)
        self.assertIn(f"callers, tets/s: {workers['rates']['tets_s']:.6g}", told)
        self.assertIn("callers: p99=900000ms held", "".join(page.texts["li"]))
        # Three latencies, the rate's steps, three throughputs, the outcomes.
        self.assertEqual(page.count("svg"), 8)
        self.assertEqual(page.count("polyline"), 3 * 2 + 2)

    def test_shows_streams_and_jobs_of_a_mix_by_themselves(self):
        ball = self.inputs / "sphere.vdb"
        (self.out / "mix").write_text(f"{ball}\n{ball} --job\n")
        self.assert_done(self.load_here(
            "--mix", self.out / "mix", "--warm-up", "0", "--quiet", "--rate", "40", "--burst", "4", "--duration", "500ms",
            report="a.json"))
        self.assert_done(render(self.out / "a.json", "-o", self.out / "page.html"))
        cells = Page((self.out / "page.html").read_text()).texts["td"]
        report = json.loads((self.out / "a.json").read_text())
        for kind in report["by_request"]:
            self.assertIn(kind["label"], cells)
            self.assertIn(f"{kind['latency_ms']['whole']['p99']:.4g}", cells)
        self.assertIn("40/s, poisson, 4 at once", cells)
        self.assertEqual(report["requests"]["offered"] % 4, 0)

    def test_needs_nothing_but_itself(self):
        self.run_load("a.json", "--rate", "20", seconds=0.3)
        self.assert_done(render(self.out / "a.json", "-o", self.out / "page.html"))
        text = (self.out / "page.html").read_text()
        for tag, attributes in Page(text).elements:
            self.assertNotIn(tag, ("link", "img", "iframe"))
            self.assertFalse({"src", "href", "srcset"} & set(attributes), attributes)
        self.assertNotIn("@import", text)
        self.assertNotIn("url(", text)

    def test_shows_errors_by_code_and_escapes_what_servers_say(self):
        report = self.run_load("a.json", "--rate", "20", seconds=0.3)
        report["errors"] = {"UNAVAILABLE": {"count": 3, "message": "</script><b>gone</b> & away"}}
        (self.out / "b.json").write_text(json.dumps(report))
        self.assert_done(render(self.out / "b.json", "-o", self.out / "page.html"))
        page = Page((self.out / "page.html").read_text())
        self.assertEqual(page.count("b"), 0)
        self.assertIn("</script><b>gone</b> & away", "".join(page.texts["td"]))
        self.assertIn("b, UNAVAILABLE: 3", page.texts["title"])

    def test_says_what_cannot_be_rendered(self):
        (self.out / "text.json").write_text("{")
        (self.out / "other.json").write_text('{"schema": 99}')
        for name, word in (("none.json", "cannot read"), ("text.json", "not JSON"),
                           ("other.json", "schema 1")):
            result = render(self.out / name, "-o", self.out / "page.html")
            self.assertEqual(result.returncode, 1)
            self.assertIn(word, result.stderr)
            self.assertFalse((self.out / "page.html").exists())


if __name__ == "__main__":
    unittest.main()
