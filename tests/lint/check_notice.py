#!/usr/bin/python3
"""Checks that NOTICE names every library that the programs load, and none that they do not.

    check_notice.py NOTICE scripts/packages.txt PROGRAM...

What `cmake/link_archives` makes archives of among these libraries becomes part of some of the programs, and has a
heading of its own. A line of NOTICE has Debian's source package first, and last the package whose copyright file has the
licence's text. What the programs load are "Linked" and "Loaded by these"; a library that is built with
(the -dev packages in the group [build]) must be somewhere.
"""
import os
import pathlib
import re
import subprocess
import sys

# They are in the tests and benchmarks alone.
NOT_SHIPPED = {"benchmark", "googletest"}
LOADED = ("Linked", "Loaded by these")
HEADERS = ("Compiled in: headers",)
ARCHIVES = ("Compiled in: archives, of tetstream and tetstream-decoder",)
LINK_ARCHIVES = pathlib.Path(__file__).parents[2] / "cmake" / "link_archives"


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def read_notice(text):
    """{heading: {source package: package with the text}}"""
    sections, lines = {}, {}
    for line in text.splitlines():
        entry = re.match(r"  (\S+) .* (\S+)$", line)
        if re.match(r"\S", line):
            lines = sections.setdefault(line, {})
        elif entry:
            lines[entry[1]] = entry[2]
    return sections


def entries_of(sections, headings):
    return {source: package for heading in headings
            for source, package in sections.get(heading, {}).items()}


def find_errors(sections, loaded, archived, built_with):
    """`loaded`, `archived` and `built_with` are sets of source packages."""
    listed = entries_of(sections, LOADED)
    known = {**listed, **entries_of(sections, HEADERS)}
    errors = [f"NOTICE lacks {source}, which the programs load" for source in loaded - set(listed)]
    errors += [f"NOTICE lists {source}, which no program loads" for source in set(listed) - loaded]
    contained = set(entries_of(sections, ARCHIVES))
    errors += [f"NOTICE lacks the archives of {source}" for source in archived - contained]
    errors += [f"NOTICE lists archives of {source}, which nothing contains" for source in contained - archived]
    errors += [f"NOTICE lacks {source}, which the programs are built with"
               for source in built_with - set(known) - NOT_SHIPPED]
    return sorted(errors) + ([] if loaded else ["no program loads any library"])


def misplaced_texts(sections):
    """Packages that are not of the source that their line names, or have no copyright file."""
    entries = [entry for headings in (HEADERS, ARCHIVES, LOADED)
               for entry in entries_of(sections, headings).items()]
    for source, package in sorted(entries):
        if not pathlib.Path("/usr/share/doc", package, "copyright").exists():
            yield f"NOTICE: {package} has no /usr/share/doc/{package}/copyright"
        elif sources_of([package]) != {source}:
            yield f"NOTICE: {package} is not of {source}"


def libraries_of(programs):
    return {path for program in programs for path in re.findall(r"=> (/\S+)", output_of("ldd", program))}


def archives_of(libraries):
    """Those that a program would have in itself of the libraries that it is linked with."""
    return re.findall(r"\S+\.a\b", output_of(LINK_ARCHIVES, "echo", *libraries))


def packages_of(files):
    """dpkg may know /usr/lib/x/y as /lib/x/y, and names the package first: "libfoo1:amd64: ..."."""
    libraries = {os.path.realpath(path) for path in files}
    names = [name for library in libraries for name in (library, library.removeprefix("/usr"))]
    # It fails for each name that it does not know, and one of the two is.
    found = subprocess.run(["dpkg", "--search", *sorted(names)], check=False, capture_output=True, text=True)
    return {line.split(":")[0] for line in found.stdout.splitlines()}


def sources_of(packages):
    if not packages:
        return set()
    shown = output_of("dpkg-query", "--show", "--showformat=${source:Package}\n", *packages)
    # libboost-dev leads to the version's own package, and is of another source.
    return {source.replace("boost-defaults", "boost1.74") for source in shown.split()}


def development_packages(path):
    text = pathlib.Path(path).read_text(encoding="utf-8")
    group = re.search(r"^\[build\]\n(.*?)(?=^\[|\Z)", text, re.MULTILINE | re.DOTALL)
    return re.findall(r"^\S+-dev$", group[1], re.MULTILINE)


def main():
    if len(sys.argv) < 4:
        sys.exit("usage: check_notice.py NOTICE scripts/packages.txt PROGRAM...")
    notice, packages, *programs = sys.argv[1:]
    sections = read_notice(pathlib.Path(notice).read_text(encoding="utf-8"))
    libraries = libraries_of(programs)
    errors = find_errors(sections, sources_of(packages_of(libraries)),
                         sources_of(packages_of(archives_of(libraries))),
                         sources_of(development_packages(packages)))
    errors += misplaced_texts(sections)
    print("\n".join(errors) or "NOTICE names what the programs are made with")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
