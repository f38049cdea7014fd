#!/usr/bin/env python3
"""The table of docs/developer/selection-rules.md has the rules of the search, and no others.

Usage: check_rules.py ODOMCALIB_BLIND DOCUMENT
"""

import pathlib
import re
import subprocess
import sys


def main():
    listed = subprocess.run([sys.argv[1], "--rules"], check=True, capture_output=True, text=True).stdout
    rules = [tuple(line.split("\t")) for line in listed.splitlines()]
    rows = re.findall(r"^\| `(\w+)` \| (.+) \|$", pathlib.Path(sys.argv[2]).read_text(encoding="utf-8"), re.MULTILINE)
    for rule in sorted(set(rules) ^ set(rows)):
        print(f"{rule[0]}: {'not in the document' if rule in rules else 'no such rule in the program'}, or in other words: {rule[1]}")
    print(f"{len(rules)} rules, {len(rows)} rows")
    return 0 if rules and rules == rows else 1


if __name__ == "__main__":
    sys.exit(main())
