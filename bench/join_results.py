#!/usr/bin/python3
"""Joins result files of Google Benchmark, of one machine and one commit, into one.

    bench/join_results.py OUT.json PART.json...
"""
import json
import pathlib
import sys


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    out, *parts = map(pathlib.Path, sys.argv[1:])
    joined = {"context": {}, "benchmarks": []}
    for part in parts:
        results = json.loads(part.read_text(encoding="utf-8"))
        joined["context"].update(results["context"])
        joined["benchmarks"] += results["benchmarks"]
    joined["context"].pop("host_name", None)  # says nothing to anybody else
    joined["context"].pop("executable", None)
    out.write_text(json.dumps(joined, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
