#!/usr/bin/python3
"""Checks the C++ and proto files themselves: a file holds one thing, so it is not long; a folder is a room, so it is
not full; and a comment is a sentence, so it does not begin like a fragment ("Of the edges, those that are cut").

    check_sources.py [ROOT]
"""
import collections
import pathlib
import re
import sys

FOLDERS = ["core", "proto", "server", "client", "bench", "tests"]
SUFFIXES = {".h", ".cpp", ".proto"}
OTHERS = ["proto/google", "proto/grpc"]  # files that came from elsewhere
MOST_LINES = 420
SHIPPED = ["core", "proto", "server", "client", "bench"]  # tests may be lists of many cases
# Whoever looks for a file sees them all at once; the fullest folder has one file a format.
MOST_FILES = 75

COMMENT = re.compile(r"^\s*//+<? ?(.*)$")
FRAGMENT = re.compile(r"(Of|The same|Likewise)\b|As [\w:]+[.,;]|(Nothing|None) (where|when|of|for)\b")
SENTENCE_END = (".", ":", "?", "!")


def is_inside(path, folders):
    return any(path == folder or path.startswith(folder + "/") for folder in folders)


def fragments(text):
    """(line, words) of the sentences of comments that begin as fragments do and stand at a line's start."""
    before = None  # the comment line above
    for number, line in enumerate(text.splitlines(), 1):
        comment = COMMENT.match(line)
        if not comment:
            before = None
            continue
        begins = before is None or before == "" or before.endswith(SENTENCE_END)
        match = FRAGMENT.match(comment[1])
        if begins and match:
            yield number, " ".join(comment[1].split()[:4])
        before = comment[1].rstrip()


def errors_of(path, text):
    lines = len(text.splitlines())
    if is_inside(path, SHIPPED) and not path.endswith(".proto") and lines > MOST_LINES:
        yield f"{path}: {lines} lines, and {MOST_LINES} are the most: does it hold one thing?"
    for number, words in fragments(text):
        yield f'{path}:{number}: a comment begins in a fragment: "{words} ..."'


def full_folders(names):
    """What is said of folders of code that ships with more sources than one sees at once."""
    files = collections.Counter(str(pathlib.PurePath(name).parent) for name in names if is_inside(name, SHIPPED))
    for folder, count in sorted(files.items()):
        if count > MOST_FILES:
            yield f"{folder}: {count} sources, and {MOST_FILES} are the most: part it into rooms"


def find_errors(root):
    paths = [path for folder in FOLDERS for path in sorted((root / folder).rglob("*"))
             if path.suffix in SUFFIXES and path.is_file()]
    if not paths:
        return [f"there are no sources under {root}"]
    texts = {str(path.relative_to(root)): path.read_text(encoding="utf-8") for path in paths}
    ours = {name: text for name, text in texts.items() if not is_inside(name, OTHERS)}
    return [*full_folders(ours), *(error for name, text in ours.items() for error in errors_of(name, text))]


def main():
    errors = find_errors(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print("\n".join(errors) or "files are short, folders are not full, and comments are sentences")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
