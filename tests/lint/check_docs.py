#!/usr/bin/python3
"""Checks Markdown files: relative links, their #anchors and the `paths` of our folders lead somewhere, and there
are the `Suite.Tests` that stand in a line with a path of tests; nothing is left to be filled in, docs/README.md lists every page beside it, and CHANGELOG.md begins with the newest version.

    check_docs.py [ROOT]
"""
import functools
import os
import pathlib
import re
import sys

SKIPPED = {"build", ".git"}
FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)
PLACEHOLDER = re.compile(r"\b(XX+|TBD|FIXME)\b")
# A file or folder of the tree in backticks; a placeholder in capitals, as in `tests/fuzz/corpus/TARGET`, is none.
PATH = re.compile(r"`((?:core|server|client|proto|bench|tests|scripts|docs|deploy|docker|cmake)/[\w./-]+)`")
CAPITALS = re.compile(r"/[A-Z]+(/|$)")
TEST_NAME = re.compile(r"`([A-Z]\w*\.(?:test_\w+|[A-Z]\w*))`")
CPP_TEST = re.compile(r"^TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", re.MULTILINE)
PYTHON_TEST = re.compile(r"^(?:class (\w+)|    def (test_\w+))", re.MULTILINE)
INDEX, CHANGELOG = "docs/README.md", "CHANGELOG.md"
SECTION = re.compile(r"^## (.*?) *$", re.MULTILINE)
VERSION = re.compile(r"(\d+)\.(\d+)\.(\d+) \((\d{4}-\d\d-\d\d|unreleased)\)")


def markdown_files(root):
    """In their order. What is skipped is not looked into, either: builds go on there."""
    found = []
    for folder, inner, files in os.walk(root):
        inner[:] = set(inner) - SKIPPED
        found += [pathlib.Path(folder, name) for name in files if name.endswith(".md")]
    return sorted(found)


def anchors_of(path):
    """The anchors GitHub gives a file's headings."""
    headings = HEADING.findall(FENCE.sub("", path.read_text(encoding="utf-8")))
    return {re.sub(r"[^\w\- ]", "", heading).lower().replace(" ", "-") for heading in headings}


def broken_links(path):
    text = CODE.sub("", FENCE.sub("", path.read_text(encoding="utf-8")))
    for link in LINK.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        target, _, anchor = link.partition("#")
        file = path.parent / target if target else path
        if not file.exists():
            yield f"{link} leads nowhere"
        elif anchor and file.suffix == ".md" and anchor not in anchors_of(file):
            yield f"{link}: no such heading"


def placeholders(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        for word in PLACEHOLDER.findall(line):
            yield f"line {number}: {word} is left to be filled in"


def lost_paths(root, path):
    """Paths that the text names and the tree does not have. A header may be named without its ending."""
    if path.name == CHANGELOG:  # it may tell of files that have gone since
        return
    for name in dict.fromkeys(PATH.findall(path.read_text(encoding="utf-8"))):
        is_there = (root / name).exists() or (root / f"{name}.h").exists()
        if not is_there and not CAPITALS.search(name):
            yield f"there is no {name}"


@functools.lru_cache(maxsize=None)
def tests_of(root):
    """The names of all tests: Suite.Name, and Class.test_name in Python."""
    names = set()
    for path in (root / "tests").rglob("*_test.cpp"):
        names |= {".".join(found) for found in CPP_TEST.findall(path.read_text(encoding="utf-8"))}
    for path in (root / "tests").rglob("*_test.py"):
        suite = None
        for begun, test in PYTHON_TEST.findall(path.read_text(encoding="utf-8")):
            suite = begun or suite
            names.add(f"{suite}.{test}")
    return names


def lost_tests(root, path):
    """Tests that a line names beside a path of tests, and that are not there."""
    if path.name == CHANGELOG:
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        if "`tests/" in line:
            yield from (f"there is no test {name}" for name in TEST_NAME.findall(line)
                        if name not in tests_of(root))


def pages_not_listed(root):
    """Pages of the folder docs that its index does not link to."""
    index = root / INDEX
    if not index.exists():
        return
    listed = {link.partition("#")[0] for link in LINK.findall(index.read_text(encoding="utf-8"))}
    for page in sorted(index.parent.glob("*.md")):
        if page != index and page.name not in listed:
            yield f"{INDEX}: {page.name} is not listed"


def changelog_errors(root):
    """The sections' titles are "1.2.3 (2026-01-31)" or "1.2.3 (unreleased)", the newest first."""
    path, newer = root / CHANGELOG, None
    if not path.exists():
        return
    for title in SECTION.findall(path.read_text(encoding="utf-8")):
        match = VERSION.fullmatch(title)
        if not match:
            yield f'{CHANGELOG}: "{title}" is not "1.2.3 (2026-01-31)" or "1.2.3 (unreleased)"'
            continue
        # "unreleased" sorts behind every date, as a release that is still to come.
        version = (tuple(int(number) for number in match.groups()[:3]), match[4])
        if newer and not (version[0] < newer[0] and version[1] <= newer[1]):
            yield f"{CHANGELOG}: {title} stands below an older version or date"
        newer = version


def find_errors(root):
    files = markdown_files(root)
    errors = [] if files else [f"there is no Markdown under {root}"]
    errors += [f"{path.relative_to(root)}: {error}" for path in files
               for error in [*broken_links(path), *placeholders(path), *lost_paths(root, path),
                             *lost_tests(root, path)]]
    return [*errors, *pages_not_listed(root), *changelog_errors(root)]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    errors = find_errors(root)
    print("\n".join(errors) or "every link leads somewhere, and every page is complete and listed")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
