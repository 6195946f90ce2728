#!/usr/bin/python3
"""Installs the library into an empty folder, and builds and runs the examples against it.

    examples_test.py SOURCE_DIR BUILD_DIR
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "tests/server"))

import running_server  # noqa: E402  (its folder is known only now)


def run(*command, **options):
    """What a command writes; all that it said where it fails."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False,
                          **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def check_snippets():
    """Every C++ snippet of docs/library.md is part of an example, line by line."""
    def lines(text):
        return [line.strip() for line in text.splitlines() if line.strip()]

    examples = ["\n".join(lines(path.read_text(encoding="utf-8")))
                for path in (SOURCE / "examples/cpp").glob("*.cpp")]
    page = (SOURCE / "docs/library.md").read_text(encoding="utf-8")
    for snippet in re.findall(r"```cpp\n(.*?)```", page, re.DOTALL):
        if not any("\n".join(lines(snippet)) in example for example in examples):
            sys.exit(f"docs/library.md: no example has\n{snippet}")


def only_ours_is_shown(library):
    """The library's own names, and none of what is linked into it."""
    for line in run("nm", "-D", "--defined-only", "--demangle", library).splitlines():
        name = line.split(maxsplit=2)[2]
        if "tetstream::" not in name or "tetstream::v1" in name:
            sys.exit(f"{library} shows {name}")


def main():
    check_snippets()
    with tempfile.TemporaryDirectory() as folder:
        prefix, out = pathlib.Path(folder, "prefix"), pathlib.Path(folder, "build")
        run("cmake", "--install", BUILD, "--prefix", prefix)
        only_ours_is_shown(next(prefix.rglob("libtetstream.so")))
        run("cmake", "-S", SOURCE / "examples/cpp", "-B", out, f"-DCMAKE_PREFIX_PATH={prefix}")
        run("cmake", "--build", out)
        packages = next(prefix.rglob("tetstream.pc")).parent
        flags = run("pkg-config", "--cflags", "--libs", "tetstream",
                    env={**os.environ, "PKG_CONFIG_PATH": str(packages)}).split()
        by_hand = out / "by_hand"
        run("c++", "-std=c++20", SOURCE / "examples/cpp/first_mesh.cpp", *flags, "-o", by_hand,
            f"-Wl,-rpath,{packages.parent}")
        with running_server.RunningServer(pathlib.Path(folder, "store")) as server:
            address = server.address
            here = run(by_hand, cwd=folder)
            served = run(out / "first_mesh", address, cwd=folder)
            tets = re.match(r"(\d+) tets", here)[1]
            assert served.count(f"{tets} tets") == 2, served
            fixture = pathlib.Path(folder, "ball.vdb")
            run(running_server.binaries() / "make_fixture", "sphere", "0.04", fixture)
            chunks = run(out / "take_chunks", address, fixture)
            assert "stopped after" in chunks, chunks
            assert pathlib.Path(folder, "ball.vtu").stat().st_size > 10_000
    print("installed, built by CMake and by pkg-config, and run")


if __name__ == "__main__":
    main()
