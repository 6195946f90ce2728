#!/usr/bin/python3
"""Checks that no name has two definitions that the linker would take for one.

    check_names.py [ROOT]

Two types of one name in one namespace, or two inline functions of one name and one list of
parameters, are one to the linker: it keeps whichever definition it meets first, of the members of a
std::vector of that type, too, and nobody is told. Names in unnamed namespaces are each file's own.
"""
import collections
import pathlib
import re
import subprocess
import sys

NAMESPACE = re.compile(r"^(?:inline )?namespace ?([\w:]*) ?\{")
END = re.compile(r"^\}  // namespace")
TYPE = re.compile(r"^(?:struct|class|union|enum(?: class| struct)?) (?:\w+_API )?(\w+)(?: final)?(?: : [^;{]*)? ?\{")
INLINE = re.compile(r"^(?:inline |constexpr )+(?!.* operator)[\w:<>&*,\[\] ]*?\b(\w+)\(([^{;]*)")


def definitions(path):
    """Names with their namespace, of functions with the types of their parameters."""
    spaces = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if begin := NAMESPACE.match(line):
            spaces.append(begin[1])
        elif END.match(line):
            spaces = spaces[:-1]
        elif "" in spaces:
            continue
        elif found := TYPE.match(line):
            yield "::".join([*spaces, found[1]])
        elif found := INLINE.match(line):
            parameters = re.sub(r"\b(const|noexcept)\b|[()]", " ", found[2]).split(",")
            kinds = [" ".join(p.split()[:-1] or p.split()) for p in parameters]
            yield f"{'::'.join([*spaces, found[1]])}({', '.join(kinds)})"


def shared_names(paths):
    """{name: files}, of what two files define."""
    files = collections.defaultdict(set)
    for path in paths:
        for name in definitions(path):
            files[name].add(path)
    return {name: sorted(map(str, found)) for name, found in files.items()
            if len(found) > 1}


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    listed = subprocess.run(["git", "-C", root, "ls-files", "*.h", "*.cpp"], check=True,
                            capture_output=True, text=True).stdout.split()
    shared = shared_names(root / name for name in listed if (root / name).exists())
    for name, files in sorted(shared.items()):
        print(f"{name} is defined in {' and in '.join(files)}")
    if shared:
        sys.exit(1)
    print("no two definitions share a name")


if __name__ == "__main__":
    main()
