#!/usr/bin/python3
"""Compares two result files of Google Benchmark (--benchmark_out=FILE, or scripts/bench).

    bench/compare.py BEFORE.json AFTER.json [--slower 1.10] [--cpu]

Prints how each benchmark's time changed, and the geometric mean of all. Of repeated runs the
median is compared. Exits 1 when one is slower by more than the ratio given with --slower, or
when no benchmark is in both files.
"""
import argparse
import json
import math
import statistics
import sys

SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


def read_times(path, key):
    """{name: seconds}; the median of what a name was measured at."""
    with open(path, encoding="utf-8") as file:
        runs = json.load(file)["benchmarks"]
    times = {}
    for run in runs:
        if run.get("run_type", "iteration") == "iteration" and not run.get("error_occurred"):
            times.setdefault(run["name"], []).append(run[key] * SECONDS[run["time_unit"]])
    return {name: statistics.median(values) for name, values in times.items()}


def told(seconds):
    """A time with a unit that fits it."""
    unit = next((u for u in ("s", "ms", "us") if seconds >= SECONDS[u]), "ns")
    return f"{seconds / SECONDS[unit]:.3g} {unit}"


def geometric_mean(ratios):
    return math.exp(sum(map(math.log, ratios)) / len(ratios))


def table(before, after, ratios):
    """Lines of text: the slowed first, then what is in one file only."""
    width = max(len(name) for name in (before | after))
    yield f"{'benchmark':{width}}  {'before':>10}  {'after':>10}  after/before"
    for name, ratio in sorted(ratios.items(), key=lambda item: -item[1]):
        yield f"{name:{width}}  {told(before[name]):>10}  {told(after[name]):>10}  {ratio:12.3f}"
    if ratios:
        yield f"{'geometric mean':{width}}  {'':>10}  {'':>10}  " \
              f"{geometric_mean(ratios.values()):12.3f}"
    for name in sorted(before.keys() ^ after.keys()):
        yield f"{name:{width}}  only in {'BEFORE' if name in before else 'AFTER'}"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--slower", type=float, metavar="RATIO",
                        help="fail when a time grew by more than this, e.g. 1.10")
    parser.add_argument("--cpu", action="store_true", help="compare CPU time, not real time")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    key = "cpu_time" if arguments.cpu else "real_time"
    before = read_times(arguments.before, key)
    after = read_times(arguments.after, key)
    ratios = {name: after[name] / before[name] for name in before.keys() & after.keys()}
    if not ratios:
        sys.exit("no benchmark is in both files")
    print("\n".join(table(before, after, ratios)))
    slowed = [name for name, ratio in ratios.items()
              if arguments.slower is not None and ratio > arguments.slower]
    if slowed:
        sys.exit(f"{len(slowed)} of {len(ratios)} are more than {arguments.slower} times "
                 f"as slow as before")


if __name__ == "__main__":
    main()
