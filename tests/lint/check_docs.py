#!/usr/bin/python3
"""Checks that relative links in Markdown files, and their #anchors, lead somewhere.

    check_docs.py [ROOT]
"""
import pathlib
import re
import sys

SKIPPED = {"build", ".git"}
FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)


def markdown_files(root):
    return [path for path in sorted(root.rglob("*.md"))
            if not SKIPPED & set(path.relative_to(root).parts)]


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


def find_errors(root):
    files = markdown_files(root)
    errors = [] if files else [f"there is no Markdown under {root}"]
    return errors + [f"{path.relative_to(root)}: {error}"
                     for path in files for error in broken_links(path)]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    errors = find_errors(root)
    print("\n".join(errors) or "every link leads somewhere")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
