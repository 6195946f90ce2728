#!/usr/bin/python3
"""Has tetstream and other meshers mesh the same solids into as many tets, and prints a table.

    compare_meshers.py [--tets N] [--solids ball,torus,...] [--meshers NAME,...]
                       [--seconds S] [--json FILE]

Each mesher reads a file and writes a file in a process of its own, as its manual shows; what is
measured is the CPU time of the whole, and what the process held at most. The size that it is asked
for is changed until it makes about as many tets as it should. One that is not installed, fails,
or takes longer than S seconds of CPU has a row that says so.
"""
import argparse
import dataclasses
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

import contenders
import judge
import solids

TRIES = 5
NEAR_ENOUGH = 0.1  # of the tets asked for
MEMORY = 12 << 30  # bytes of address space


class Failed(Exception):
    """Why there is no mesh."""


@dataclasses.dataclass
class Run:
    cpu_seconds: float = 0
    peak_bytes: int = 0


def last_words(log):
    """What a program that failed said of it: its first error, or whatever it said last."""
    lines = log.read_text("utf-8", "replace").strip().splitlines() or ["without a word"]
    errors = [line for line in lines if line.lower().startswith("error")]
    return " ".join((errors[0] if errors else lines[-1]).split())[:100]


def run(commands, folder, seconds):
    """Runs one after the other, and gives up where one fails. Returns the Run of them all."""
    whole = Run()

    def limit():
        left = max(int(np.ceil(seconds - whole.cpu_seconds)), 1)
        resource.setrlimit(resource.RLIMIT_CPU, (left, left + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    for command in commands:
        with open(folder / "log.txt", "wb") as log:
            process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=log,
                                       stderr=subprocess.STDOUT, preexec_fn=limit)
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        whole.cpu_seconds += usage.ru_utime + usage.ru_stime
        whole.peak_bytes = max(whole.peak_bytes, usage.ru_maxrss * 1024)
        if process.returncode != 0:
            if whole.cpu_seconds >= seconds - 1:
                raise Failed(f"not done after {seconds:g} s")
            told, code = last_words(folder / "log.txt"), process.returncode
            raise Failed(f"{f'signal {-code}' if code < 0 else f'exit {code}'}: {told}")
    return whole


def read(path):
    """(vertices, tets, labels or None) of what a contender wrote."""
    if not path.exists():
        raise Failed("no mesh was written")
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            return arrays["vertices"], arrays["tets"].astype(np.int64), arrays.get("labels")
    if path.suffix == ".stl":  # a surface: its corners, and its triangles in place of tets
        record = np.dtype([("normal", "<f4", 3), ("at", "<f4", (3, 3)), ("rest", "<u2")])
        corners = np.fromfile(path, record, offset=84)["at"].astype(np.float64)
        vertices, ids = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        return vertices, ids.reshape(-1, 3), None
    try:
        return judge.read_mesh(path)
    except Exception as error:  # meshio lets out whatever its readers come upon
        raise Failed(f"a mesh without tets, or none that can be read: {error}"[:100]) from error


def judge_surface(vertices, triangles, distance):
    """A Verdict on what has no tets; its count is of triangles."""
    at = np.concatenate([vertices, vertices[triangles].mean(axis=1)])
    at = np.random.default_rng(0).choice(at, min(len(at), judge.SAMPLES), replace=False)
    far = np.abs(distance(at))
    return judge.Verdict(len(triangles), float("nan"), float("nan"), 0, 0,
                         solids.triangles_volume(vertices, triangles),
                         rms=np.sqrt((far ** 2).mean()), worst=far.max())


def mesh(contender, solid, wanted, seconds, folder):
    """(Verdict, Run) of the try that came nearest to so many tets."""
    size = contender.guess * (solid.volume / wanted) ** (1 / 3)
    best = before = None
    for _ in range(TRIES):
        for old in folder.iterdir():
            old.unlink()
        prepared = contender.prepare(solid, size, folder)
        if isinstance(prepared, str):
            raise Failed(prepared)
        try:
            measured = run(prepared[0], folder, seconds)
            vertices, tets, labels = read(prepared[1])
            if len(tets) == 0:
                raise Failed("a mesh without tets")
        except Failed:
            if best is None:
                raise
            break  # a smaller one was made; that is told
        ratio = len(tets) / wanted
        print(f"    {contender.name}, {solid.name}: {size:.4g} gives {len(tets)} tets, "
              f"{measured.cpu_seconds:.2f} s", file=sys.stderr)
        if best is None or abs(np.log(ratio)) < abs(np.log(best[0])):
            best = ratio, measured, vertices, tets, labels
        if abs(ratio - 1) < NEAR_ENOUGH or len(tets) == before:
            break  # or it does not do as it is asked
        before = len(tets)
        size *= ratio ** (1 / 2 if contender.surface else 1 / 3)
    _, measured, vertices, tets, labels = best
    if contender.surface:
        return judge_surface(vertices, tets, solid.distance), measured
    return judge.judge(vertices, tets, labels, solid.distance), measured


def row_of(contender, solid, wanted, seconds):
    """What the table and its file tell of one contender and one solid."""
    row = {"solid": solid.name, "mesher": contender.name}
    if not contender.found():
        return {**row, "failure": f"not installed: {contender.package or 'scripts/build release'}"}
    with tempfile.TemporaryDirectory() as folder:
        try:
            # Half as many triangles as tets: about what the surface of such a mesh has.
            verdict, measured = mesh(contender, solid, wanted / (2 if contender.surface else 1),
                                     seconds, pathlib.Path(folder))
        except Failed as failure:
            return {**row, "failure": str(failure)}
    return {**row, **dataclasses.asdict(verdict), **dataclasses.asdict(measured),
            "expected_labels": solid.labels,
            "volume_error": verdict.volume / solid.volume - 1}


def told(row):
    """The row's cells."""
    if "failure" in row:
        return [row["solid"], row["mesher"], row["failure"], *[""] * 8]
    remarks = [f"{row['flat']} flat or turned tets"] if row["flat"] else []
    remarks += [f"{row['loose']} places where it is no solid"] if row["loose"] and row["labels"] == 1 else []
    if row["labels"] != row["expected_labels"]:
        remarks.append(f"{row['labels']} labels of {row['expected_labels']}")
    angles = ["", ""] if np.isnan(row["min_deg"]) else [f"{row['min_deg']:.2f}",
                                                        f"{row['max_deg']:.1f}"]
    return [row["solid"], row["mesher"], f"{row['tets']}", f"{row['cpu_seconds']:.2f}",
            f"{row['tets'] / row['cpu_seconds']:.3g}", f"{row['peak_bytes'] / 1e6:.0f}", *angles,
            "" if row["rms"] is None else f"{1000 * row['rms']:.2f}",
            f"{100 * row['volume_error']:+.2f}", "; ".join(remarks)]


HEADER = ["solid", "mesher", "tets", "CPU s", "tets/CPU s", "peak MB", "least angle", "greatest",
          "rms of the surface, 1/1000", "volume, %", "remarks"]


def write_whole(path, what):
    """Replaces the file with all that is known so far, or leaves it as it is."""
    path = pathlib.Path(path)
    part = path.with_name(path.name + ".part")
    part.write_text(json.dumps(what, indent=1, default=float), encoding="utf-8")
    part.replace(path)


def print_row(cells):
    print("| " + " | ".join(cells) + " |", flush=True)


def chosen(given, known, what):
    names = given.split(",") if given else list(known)
    unknown = [name for name in names if name not in known]
    if unknown:
        sys.exit(f"compare_meshers: no {what} {unknown[0]}; there are {', '.join(known)}")
    return [known[name] for name in names]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--tets", type=int, default=100_000, help="of each mesh [100000]")
    parser.add_argument("--solids", default="", help="some of ball,torus,gyroid,bunny,grains")
    parser.add_argument("--meshers", default="", help="some, by their names in the table")
    parser.add_argument("--seconds", type=float, default=600, help="of CPU for one mesh [600]")
    parser.add_argument("--json", help="file for all that was measured")
    args = parser.parse_args()
    if not 1000 <= args.tets <= 100_000_000 or not 1 <= args.seconds <= 100_000:
        parser.error("--tets is 1000 to 100000000, --seconds 1 to 100000")
    meshers = chosen(args.meshers, {c.name: c for c in contenders.CONTENDERS}, "mesher")
    rows, start = [], time.strftime("%Y-%m-%d")
    makers = chosen(args.solids, solids.all_solids(), "solid")
    print_row(HEADER)
    print_row(["---"] * len(HEADER))
    for make in makers:
        solid = make()
        for contender in meshers:
            rows.append(row_of(contender, solid, args.tets, args.seconds))
            print_row(told(rows[-1]))
            if args.json:
                write_whole(args.json, {"date": start, "tets": args.tets, "rows": rows})


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
