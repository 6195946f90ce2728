#!/usr/bin/python3
"""Checks that programs do not load, when they start, what only a module of theirs needs.

    check_startup.py LIBRARY PROGRAM... MODULE

No program may load a library of that name, directly or by way of others; the module must, or nothing
was compared.
"""
import subprocess
import sys


def loads(path, library):
    done = subprocess.run(["ldd", path], check=True, capture_output=True, text=True)
    return any(line.split()[0].startswith(library) for line in done.stdout.splitlines() if line.strip())


def main():
    library, *programs, module = sys.argv[1:]
    errors = [f"{program} loads {library} when it starts" for program in programs if loads(program, library)]
    errors += [] if loads(module, library) else [f"{module} does not load {library}"]
    print("\n".join(errors) or f"no program loads {library} when it starts")
    sys.exit(1 if errors else 0)


main()
