#!/usr/bin/python3
"""Renders runs of tetstream-load as one HTML page that needs nothing else.

    bench/load/report_page.py RUN.json [NAME=RUN.json ...] -o PAGE.html

Each RUN.json is what `tetstream-load ... --json RUN.json` wrote, of a run or of a search (then of
its best trial). Runs are called by their files' names unless a NAME is given. All figures are in the
page as JSON too, in the element with the id `runs`.
"""
import argparse
import json
import pathlib
import sys
import xml.etree.ElementTree as ET

from svg_charts import add, bar_chart, colour, line_chart, short

SCHEMA = 1

# Where percentiles are drawn: evenly in the number of nines.
PERCENTILES = [("p50", 0.301, 0.5), ("p90", 1.0, 0.9), ("p99", 2.0, 0.99), ("p99_9", 3.0, 0.999)]
MAX_X = 3.7
PERCENTILE_TICKS = [(x, key.replace("_", ".")) for key, x, _ in PERCENTILES] + [(MAX_X, "max")]

LATENCIES = [("whole", "Whole mesh"), ("first_chunk", "First chunk"), ("header", "Header")]

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem;
       color: #1a1a1a; background: #fff }
h1 { font-size: 1.5rem } h2 { font-size: 1.1rem; margin: 1.6rem 0 .4rem }
table { border-collapse: collapse; font-variant-numeric: tabular-nums }
.wide { overflow-x: auto }
th, td { padding: .25rem .7rem; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap }
th:first-child, td:first-child { text-align: left }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 1rem }
figure { margin: 0 } figcaption { font-weight: 600 }
svg { width: 100%; height: auto } svg text { font-size: 12px; fill: #444 }
svg .grid { stroke: #e3e3e3 }
.key { display: inline-block; width: .8em; height: .8em; margin-right: .4em }
.aside { color: #555 }
"""


class Refusal(Exception):
    """What is wrong with an input, for its user."""


def read_run(argument):
    """{name, file, report, search}: what was measured, whatever it was part of."""
    name, separator, path = argument.partition("=")
    if not separator:
        name, path = pathlib.Path(argument).stem, argument
    try:
        whole = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise Refusal(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise Refusal(f"{path} is not JSON: {error}") from error
    if not isinstance(whole, dict) or whole.get("schema") != SCHEMA:
        raise Refusal(f"{path} is not a report of tetstream-load of schema {SCHEMA}")
    measured = whole if "search" not in whole else whole["best"]
    if measured is None:
        raise Refusal(f"{path} is a search that found no rate")
    return {"name": name, "server": whole["server"], "started": whole["started"],
            "encoding": whole["encoding"], "mix": whole["mix"], "search": whole.get("search"),
            **{key: measured[key] for key in (
                "plan", "rates", "requests", "errors", "latency_ms", "targets", "by_step",
                "by_request", "interrupted", "notes")}}


def plan_text(plan):
    if plan["mode"] == "workers":
        return f"{plan['workers']} workers, back to back"
    rates = [step["per_second"] for step in plan["steps"]]
    steps = f"{short(rates[0])}" if len(rates) == 1 else f"{short(rates[0])} to {short(rates[-1])}"
    return f"{steps}/s, {plan['arrivals']}"


def table(parent, header, rows):
    """`rows` are lists of cells; the first cell of each has the run's colour."""
    whole = add(add(parent, "div", class_="wide"), "table")
    line = add(add(whole, "thead"), "tr")
    for cell in header:
        add(line, "th", cell)
    body = add(whole, "tbody")
    for index, row in enumerate(rows):
        line = add(body, "tr")
        first = add(line, "td")
        add(first, "span", class_="key", style=f"background:{colour(index)}").tail = row[0]
        for cell in row[1:]:
            add(line, "td", str(cell))


def told_ms(latency, key):
    return f"{latency[key]:.4g}" if latency["count"] else "-"


def overview(body, runs):
    add(body, "h2", "Runs")
    table(body, ["run", "asked for", "measured s", "offered", "done", "failed", "unfinished",
                 "dropped", "done/s", "tets/s", "bytes/s", "highest rate"], [
        [run["name"], plan_text(run["plan"]), f"{run['rates']['seconds']:.3g}",
         *(run["requests"][key] for key in (
             "offered", "done", "failed", "unfinished", "dropped")),
         short(run["rates"]["done_s"]), short(run["rates"]["tets_s"]),
         short(run["rates"]["bytes_s"]),
         f"{run['search']['per_second']:.3g}/s" if run["search"] else "-"] for run in runs])


def percentile_points(latency):
    """[(x, ms, hollow)]; hollow where less than one request is expected beyond."""
    if not latency["count"]:
        return []
    points = [(x, latency[key], latency["count"] * (1 - fraction) < 1)
              for key, x, fraction in PERCENTILES]
    points.append((MAX_X, latency["max"], False))
    return [point for point in points if point[1] > 0]


def figure(parent, caption):
    element = add(parent, "figure")
    add(element, "figcaption", caption)
    return element


def latencies(body, runs):
    add(body, "h2", "Latency from the moment a request was due")
    add(body, "p", "Hollow: less than one request is expected beyond this percentile, so that it is "
        "the maximum by another name. Requests that failed are in no latency; those given up count "
        "with the time until then.", class_="aside")
    charts = add(body, "div", class_="charts")
    for kind, title in LATENCIES:
        line_chart(figure(charts, title),
                   [(run["name"], percentile_points(run["latency_ms"][kind])) for run in runs],
                   PERCENTILE_TICKS, "ms")
    for kind, title in LATENCIES:
        add(body, "h2", f"{title}, ms")
        keys = [key for key, _, _ in PERCENTILES] + ["max", "mean"]
        table(body, ["run", "requests", *(key.replace("_", ".") for key in keys)], [
            [run["name"], run["latency_ms"][kind]["count"],
             *(told_ms(run["latency_ms"][kind], key) for key in keys)] for run in runs])


def step_points(run):
    points = [(step["per_second"], step["latency_ms"]["whole"]["p99"], False)
              for step in run["by_step"] if step["latency_ms"]["whole"]["count"]]
    return [point for point in points if point[1] > 0]


def rate_steps(body, runs):
    """Where the rate was changed: what that did to the 99th percentile."""
    stepped = [run for run in runs if run["plan"]["mode"] == "open" and len(run["by_step"]) > 1]
    if not stepped:
        return
    add(body, "h2", "Whole mesh, p99, by the rate of requests")
    rates = sorted({point[0] for run in stepped for point in step_points(run)}) or [0]
    middle = rates[len(rates) // 2]
    ticks = [(rate, f"{short(rate)}/s") for rate in sorted({rates[0], middle, rates[-1]})]
    line_chart(figure(add(body, "div", class_="charts"), "Steps"),
               [(run["name"], step_points(run) if run in stepped else []) for run in runs], ticks,
               "ms")


def throughput(body, runs):
    add(body, "h2", "Received a second")
    charts = add(body, "div", class_="charts")
    names = [run["name"] for run in runs]
    for key, title in (("tets_s", "tets/s"), ("bytes_s", "bytes/s"), ("done_s", "meshes/s")):
        bar_chart(figure(charts, title), names,
                  [(title, colour, [run["rates"][key] for run in runs])], "")


def outcomes(body, runs):
    """What became of the requests offered: done, failed by code, given up, dropped."""
    add(body, "h2", "What became of the requests")
    codes = sorted({code for run in runs for code in run["errors"]})
    parts = [("done", "#b8c4cc", [run["requests"]["done"] for run in runs])]
    parts += [(code, colour(i + 1),
               [run["errors"].get(code, {"count": 0})["count"] for run in runs])
              for i, code in enumerate(codes)]
    parts += [("unfinished", "#777", [run["requests"]["unfinished"] for run in runs]),
              ("dropped", "#333", [run["requests"]["dropped"] for run in runs])]
    bar_chart(figure(add(body, "div", class_="charts"), "Requests"),
              [run["name"] for run in runs], parts, "")
    legend = add(body, "p", class_="aside")
    for name, ink, _ in parts:
        add(legend, "span", class_="key", style=f"background:{ink}").tail = f"{name}   "
    if codes:
        table(body, ["run", *codes, "first message"], [
            [run["name"], *(run["errors"].get(code, {"count": 0})["count"] for code in codes),
             next((error["message"] for error in run["errors"].values()), "")] for run in runs])


def notes(body, runs):
    add(body, "h2", "To know before believing the figures")
    items = add(body, "ul")
    if len({json.dumps([run["mix"], run["encoding"]], sort_keys=True) for run in runs}) > 1:
        add(items, "li", "The runs did not ask for the same meshes.")
    for run in runs:
        add(items, "li", f"{run['name']}: {run['server']}, {run['started']}, {run['encoding']} "
            f"chunks; " + "; ".join(entry["label"] for entry in run["mix"]))
        for note in run["notes"]:
            add(items, "li", f"{run['name']}: {note}")
        if run["interrupted"]:
            add(items, "li", f"{run['name']}: was stopped before its end.")
        for target in run["targets"]:
            held = "held" if target["held"] else f"NOT held, {target['missed']} missed it"
            add(items, "li", f"{run['name']}: {target['target']} {held}")


def page(runs):
    """The whole page as text."""
    html = ET.Element("html", lang="en")
    head = add(html, "head")
    add(head, "meta", charset="utf-8")
    add(head, "meta", name="viewport", content="width=device-width, initial-scale=1")
    add(head, "title", "tetstream under load")
    add(head, "style", STYLE)
    body = add(html, "body")
    add(body, "h1", "tetstream under load")
    for section in (overview, latencies, rate_steps, throughput, outcomes, notes):
        section(body, runs)
    # Text of a script is not escaped; these are the letters that could end it.
    figures = json.dumps(runs).replace("<", "\\u003c").replace("&", "\\u0026")
    add(body, "script", figures, type="application/json", id="runs")
    return "<!DOCTYPE html>\n" + ET.tostring(html, encoding="unicode", method="html") + "\n"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="[NAME=]RUN.json")
    parser.add_argument("-o", "--output", required=True, metavar="PAGE.html")
    arguments = parser.parse_args()
    try:
        text = page([read_run(argument) for argument in arguments.runs])
        pathlib.Path(arguments.output).write_text(text, encoding="utf-8")
    except (Refusal, OSError) as error:
        print(f"report_page.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
