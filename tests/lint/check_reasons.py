#!/usr/bin/python3
"""Checks that every reason of a failure is known everywhere: in the server's sources, in the list of
proto/convert/reasons.h and in the table of docs/errors.md.

    check_reasons.py [ROOT]
"""
import pathlib
import re
import sys

LIST, TABLE = "proto/convert/reasons.h", "docs/errors.md"
# Reasons that a gRPC code brings along; no source names them.
OF_CODES = {"CANCELLED", "DEADLINE_EXCEEDED", "INTERNAL"}
# Text in capitals that is no reason.
OTHER_TEXT = re.compile(r"TETSTREAM_.*|OTHER|CERTIFICATE|PRIVATE|NAME|UTF8|COMMIT|ROLLBACK|QUEUED|RUNNING|"
                        r"SUCCEEDED|FAILED|EXPIRED|UNKNOWN|DELETE|HEAD|OPTIONS|POST|[A-Z]{1,3}")
LITERAL = re.compile(r'"([A-Z][A-Z0-9_]+)"')
ROW = re.compile(r"^\| `([A-Z0-9_]+)` \|", re.MULTILINE)


def reasons_in_sources(root):
    """{reason: file} of every literal in capitals."""
    found = {}
    for path in sorted([*(root / "server").rglob("*.cpp"), *(root / "proto").glob("convert/*.cpp"),
                       *(root / "core" / "vdb").rglob("*.cpp")]):
        for text in LITERAL.findall(path.read_text(encoding="utf-8")):
            if not OTHER_TEXT.fullmatch(text):
                found.setdefault(text, str(path.relative_to(root)))
    return found


def find_errors(root):
    used = reasons_in_sources(root)
    listed = LITERAL.findall((root / LIST).read_text(encoding="utf-8"))
    told = ROW.findall((root / TABLE).read_text(encoding="utf-8"))
    errors = [f"{file}: {reason} is not in {LIST}" for reason, file in used.items()
              if reason not in listed]
    errors += [f"{LIST}: no source uses {reason}" for reason in listed
               if reason not in used and reason not in OF_CODES]
    errors += [f"{TABLE}: lacks {reason}" for reason in listed if reason not in told]
    errors += [f"{TABLE}: {reason} is not in {LIST}" for reason in told if reason not in listed]
    errors += [f"{file}: not in the order of the alphabet" for file, names in
               ((LIST, listed), (TABLE, told)) if names != sorted(names)]
    return errors


def main():
    errors = find_errors(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    print("\n".join(errors) or "every reason is known everywhere")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
