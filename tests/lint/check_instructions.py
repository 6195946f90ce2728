#!/usr/bin/python3
"""Checks that programs use no MMX register: whoever leaves one in use breaks long doubles.

    check_instructions.py PROGRAM...
"""
import re
import subprocess
import sys

MMX = re.compile(r"%mm[0-7]\b")


def disassembly(program, *options):
    return subprocess.run(["objdump", "--disassemble", "--no-show-raw-insn", *options, program],
                          check=True, capture_output=True).stdout


def functions_with_mmx(program):
    """Names of the functions, as objdump shows them."""
    if b"%mm" not in disassembly(program):
        return []  # as always; with names, line by line, it would take twice as long
    listing = disassembly(program, "--demangle").decode("utf-8", "replace")
    found, function = [], "?"
    for line in listing.splitlines():
        if line.endswith(">:"):
            function = line.split(" ", 1)[1]
        elif MMX.search(line) and (not found or found[-1] != function):
            found.append(function)
    return found


def main():
    programs = sys.argv[1:]
    errors = [f"{program}: MMX in {function}"
              for program in programs for function in functions_with_mmx(program)]
    print("\n".join(errors) or f"no MMX in {len(programs)} programs")
    sys.exit(1 if errors or not programs else 0)


if __name__ == "__main__":
    main()
