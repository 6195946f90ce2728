#!/usr/bin/python3
"""Checks that every part of a script of tests is run: where ctest runs a script part by part, a part that no
CMakeLists.txt names would pass for ever.

    check_registered.py [ROOT]
"""
import ast
import pathlib
import re
import sys

# tet_server_tests(http_test.py "slow;service" GrpcWeb Json), page_test(page_test.mjs Meshes)
CALL = re.compile(r'^\s*\w+_tests?\(\s*(\w+\.(?:py|mjs))\s+([^)]*)\)', re.MULTILINE)
LABELS = re.compile(r'"[^"]*"')
PAGE_PART = re.compile(r'^part\("(\w+)"', re.MULTILINE)


def parts_named(root):
    """{script: the words behind it} of scripts that are run part by part."""
    named = {}
    for lists in sorted((root / "tests").rglob("CMakeLists.txt")):
        for script, words in CALL.findall(lists.read_text(encoding="utf-8")):
            named.setdefault(lists.parent / script, set()).update(LABELS.sub("", words).split())
    return named


def test_classes(text):
    """Classes with tests of their own, or of another class of the file that has some."""
    with_tests = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.ClassDef):
            own = any(isinstance(part, ast.FunctionDef) and part.name.startswith("test_") for part in node.body)
            bases = {base.id for base in node.bases if isinstance(base, ast.Name)}
            with_tests[node.name] = own or any(with_tests.get(base) for base in bases)
    return [name for name, has_tests in with_tests.items() if has_tests]


def find_errors(root):
    errors = []
    for script, named in parts_named(root).items():
        text = script.read_text(encoding="utf-8")
        parts = PAGE_PART.findall(text) if script.suffix == ".mjs" else test_classes(text)
        errors += [f"{script.relative_to(root)}: no CMakeLists.txt has ctest run {part}"
                   for part in parts if part not in named]
    return errors


def main(root="."):
    errors = find_errors(pathlib.Path(root))
    print("\n".join(errors) or "every part of a script of tests is run")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
