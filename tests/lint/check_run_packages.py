#!/usr/bin/python3
"""Checks that the container's final stage gets every library the programs load.

    check_run_packages.py scripts/packages.txt PROGRAM...

The group [run] of the list must be the packages of the programs' own (direct) libraries, apart from
those every Debian image has.
"""
import os
import re
import subprocess
import sys

IN_EVERY_IMAGE = {"libc6", "libgcc-s1", "libstdc++6", "zlib1g"}


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def libraries_of(program):
    """Paths of the libraries that a program names itself, not those that these load in turn."""
    direct = set(re.findall(r"\(NEEDED\).*\[(.+)\]", output_of("readelf", "--dynamic", program)))
    loaded = re.findall(r"(\S+) => (/\S+)", output_of("ldd", program))
    return {os.path.realpath(path) for name, path in loaded if name in direct}


def packages_of(libraries):
    """dpkg may know /usr/lib/x/y as /lib/x/y, and names the package first: "libfoo1:amd64: ...". It reads all
    that is installed for each call, and fails where it knows one of the names not."""
    names = [name for library in libraries for name in (library, library.removeprefix("/usr"))]
    found = subprocess.run(["dpkg", "--search", *sorted(names)], check=False, capture_output=True, text=True)
    owners = dict(reversed(line.split(": ", 1)) for line in found.stdout.splitlines())
    unknown = [library for library in libraries
               if library not in owners and library.removeprefix("/usr") not in owners]
    if unknown:
        sys.exit(f"no package has {', '.join(sorted(unknown))}")
    return {owner.split(":")[0] for owner in owners.values()}


def listed_packages(path):
    with open(path, encoding="utf-8") as file:
        group = re.search(r"^\[run\]\n(.*?)(?=^\[|\Z)", file.read(), re.MULTILINE | re.DOTALL)
    return set(re.findall(r"^[a-z0-9]\S*", group[1], re.MULTILINE)) if group else set()


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: check_run_packages.py scripts/packages.txt PROGRAM...")
    packages, *programs = sys.argv[1:]
    libraries = {library for program in programs for library in libraries_of(program)}
    needed = packages_of(libraries) - IN_EVERY_IMAGE
    listed = listed_packages(packages)
    errors = [f"{packages}: [run] lacks {package}" for package in sorted(needed - listed)]
    errors += [f"{packages}: [run] lists {package}, which no program loads"
               for package in sorted(listed - needed)]
    errors += [] if libraries else ["no program loads any library"]
    print("\n".join(errors) or "the container gets every library it needs")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
