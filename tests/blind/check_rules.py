#!/usr/bin/env python3
"""The tables of docs/developer/selection-rules.md have the rules of the search and their groups, and no others.

Usage: check_rules.py ODOMCALIB_BLIND DOCUMENT
"""

import pathlib
import re
import subprocess
import sys


def listed(program, option):
    text = subprocess.run([program, option], check=True, capture_output=True, text=True).stdout
    return [tuple(line.split("\t")) for line in text.splitlines()]


def main():
    text = pathlib.Path(sys.argv[2]).read_text(encoding="utf-8")
    is_right = True
    for option, row in (("--rules", r"^\| `(\w+)` \| (\w+) \| (.+) \|$"), ("--rule-groups", r"^\| `(\w+)` \| ([^|]+) \|$")):
        of_program, of_document = listed(sys.argv[1], option), re.findall(row, text, re.MULTILINE)
        for line in sorted(set(of_program) ^ set(of_document)):
            where = "not in the document" if line in of_program else "not in the program"
            print(f"{line[0]}: {where}, or in other words: {', '.join(line[1:])}")
        print(f"{option}: {len(of_program)} in the program, {len(of_document)} rows")
        is_right = is_right and bool(of_program) and of_program == of_document
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())
