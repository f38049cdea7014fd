#!/usr/bin/env python3
"""Checks that documents lead somewhere: links of Markdown files, and every docs/... path that a text file names.

Usage: check_docs.py [PROJECT_ROOT]      lists what leads nowhere, exit status 1 if anything does
       check_docs.py --self-test         shows that each rule accepts what is right and rejects what is wrong
"""

import pathlib
import re
import sys
import tempfile

LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)")
# A path with an extension; docs/user and the like are folders that sentences name.
NAMED = re.compile(r"\bdocs/[\w/.-]*\.(?:md|py|sh|svg|[1-8])\b")
FOLDERS = ("calib", "daemon", "docs", "drivers", "proto", "systemd", "tests")
# Fuzzing inputs are bytes, and this file names paths that are not there.
SKIPPED = ("tests/fuzz/corpus/", "tests/check_docs.py", "__pycache__")


def links(path, text):
    """Files that the links of a Markdown file lead to."""
    return [path.parent / target for target in LINK.findall(text) if "://" not in target]


def problems(root, names):
    """One line for each link or path of the files `names` (relative to `root`) that leads nowhere."""
    found = []
    for name in names:
        path = root / name
        try:
            text = path.read_text(encoding="utf-8")
        except (UnicodeDecodeError, OSError):
            continue
        wanted = links(path, text) if name.endswith(".md") else []
        wanted += [root / named for named in NAMED.findall(text)]
        found += [f"{name}: {target.relative_to(root) if target.is_relative_to(root) else target} is not there"
                  for target in wanted if not target.exists()]
    return found


def sources(root):
    """Files at the top and below the folders of the project, relative to `root`."""
    paths = [path for path in root.iterdir() if path.is_file()]
    for folder in FOLDERS:
        paths += (path for path in (root / folder).rglob("*") if path.is_file())
    names = sorted(path.relative_to(root).as_posix() for path in paths)
    return [name for name in names if not any(skipped in name for skipped in SKIPPED)]


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "docs").mkdir()
        (root / "docs/there.md").write_text("[here](there.md#part) [web](https://example.org/x.md)\n")
        (root / "lost.md").write_text("[lost](docs/gone.md)\n")
        (root / "good.hpp").write_text("// docs/there.md\n")
        (root / "bad.hpp").write_text("// see docs/gone.md.\n")
        assert problems(root, ["docs/there.md", "good.hpp"]) == []
        assert len(problems(root, ["lost.md"])) == 2  # the link, and the path in it
        assert problems(root, ["bad.hpp"]) == ["bad.hpp: docs/gone.md is not there"]
    print("4 files judged rightly")


def main():
    if "--self-test" in sys.argv:
        self_test()
        return 0
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = problems(root, sources(root))
    print("\n".join(found + [f"{len(found)} links or paths of documents lead nowhere"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
