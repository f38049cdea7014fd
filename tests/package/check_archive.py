"""The archive that runs where it is unpacked, on a Debian 12 with nothing else installed: check_archive.py FOLDER WORK_FOLDER SOURCE_FOLDER

FOLDER holds the archive. The Debian is made once, in the work folder, by mmdebstrap."""

import pathlib
import re
import shutil
import subprocess
import sys
import time
import unittest

folder, work, source = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
RUNTIMES = {"linux-vdso.so.1", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1", "libc.so.6", "libm.so.6", "libstdc++.so.6",
            "libgcc_s.so.1"}
# Versions of Ubuntu 22.04, the oldest of the four: glibc 2.35 and the C++ runtime of GCC 12.
NEWEST = {"GLIBC": (2, 35), "GLIBCXX": (3, 4, 30)}
MOST_BYTES = 15_000_000


def told(*command, **options):
    done = subprocess.run([str(word) for word in command], check=False, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def bare_debian():
    """A root folder, fresh each time."""
    image, root = work / "bookworm.tar", work / "root"
    work.mkdir(parents=True, exist_ok=True)
    if not image.exists():
        told("mmdebstrap", "--variant=minbase", "bookworm", work / "new.tar")
        (work / "new.tar").rename(image)
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir()
    told("tar", "-xf", image, "-C", root, "--no-same-owner", "--exclude=./dev/*")
    (root / "try").mkdir()
    return root


class Archive(unittest.TestCase):
    SOLVE = "bin/odomcalibctl solve share/odomcalib/examples/drive.jsonl.gz --report report.html"

    @classmethod
    def setUpClass(cls):
        version = re.search(r"project\(odomcalib VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text())[1]
        cls.name = f"odomcalib-{version}-linux-{told('uname', '-m').strip()}"
        cls.zst, cls.gz = folder / f"{cls.name}.tar.zst", folder / f"{cls.name}.tar.gz"
        cls.root = bare_debian()
        shutil.copy(cls.gz, cls.root / "try")
        begin = time.monotonic()
        cls.inside(f"tar -xf {cls.gz.name}")
        cls.said = cls.inside(cls.SOLVE, cls.name)
        print(f"from the archive to a report in two commands: {time.monotonic() - begin:.1f} s")

    @classmethod
    def inside(cls, command, where="."):
        enter = ('mount --rbind /dev "$1/dev" && mount --rbind /proc "$1/proc" && '
                 'exec chroot "$1" env -i PATH=/usr/bin:/bin sh -euc "cd /try/$2; $3"')
        return told("unshare", "-r", "--mount", "sh", "-euc", enter, "sh", cls.root, where, command)

    def unpacked(self):
        return self.root / "try" / self.name

    def programs_and_libraries(self):
        return [path for part in ("bin", "lib") for path in (self.unpacked() / part).iterdir()]

    def test_two_commands_lead_from_the_archive_to_a_report(self):
        self.assertTrue(self.said.startswith("ACCEPTED"), self.said)
        self.assertIn("<svg", (self.unpacked() / "report.html").read_text())

    def test_it_is_small(self):
        print(f"{self.zst.name}: {self.zst.stat().st_size} bytes, {self.gz.name}: {self.gz.stat().st_size} bytes")
        self.assertLess(self.zst.stat().st_size, MOST_BYTES)

    def test_both_archives_hold_the_same(self):
        self.assertEqual(sorted(told("tar", "-tf", self.zst).split("\n")), sorted(told("tar", "-tf", self.gz).split("\n")))

    def test_of_the_system_it_needs_the_runtimes_alone(self):
        for program in ("odomcalibctl", "odomcalib-sim-record"):
            listing = self.inside(f"ldd bin/{program}", self.name)
            print(f"ldd {program}\n{listing}")
            for line in listing.splitlines():
                words = line.split()
                name = pathlib.PurePath(words[0]).name
                own = f"/try/{self.name}/bin/../lib/{name}"
                self.assertTrue(name in RUNTIMES or words[1:3] == ["=>", own], line)

    def test_needs_no_newer_runtimes_than_the_oldest_system_has(self):
        highest = {kind: (0,) for kind in NEWEST}
        for path in self.programs_and_libraries():
            for kind, version in re.findall(r"\b(GLIBC|GLIBCXX)_([0-9.]+)", told("objdump", "-T", path)):
                highest[kind] = max(highest[kind], tuple(map(int, version.split("."))))
        print("highest symbols:", {kind: ".".join(map(str, version)) for kind, version in highest.items()})
        for kind, version in highest.items():
            self.assertLessEqual(version, NEWEST[kind], kind)
            self.assertGreater(version, (2,), kind)

    def test_has_the_licence_of_every_library(self):
        licences = {path.name for path in (self.unpacked() / "licences").iterdir()}
        for path in (self.unpacked() / "lib").iterdir():
            package = told("dpkg", "-S", f"*/{path.name}").split(":")[0]
            self.assertIn(package, licences, path.name)
        self.assertIn("LGPL-2.1", licences)
        self.assertTrue((self.unpacked() / "LICENSE").exists())

    def test_every_container_is_read(self):
        self.inside("for kind in mcap bag db3 jsonl.gz; do bin/odomcalib-sim-record --drive random --duration 10 --out d.$kind; "
                    "bin/odomcalibctl inspect d.$kind; done", self.name)

    def test_profiles_are_found_from_elsewhere_and_after_it_was_moved(self):
        shutil.rmtree(self.root / "try/moved", ignore_errors=True)
        shutil.copytree(self.unpacked(), self.root / "try/moved", symlinks=True)
        self.inside("echo '(1.0) can0 701#05' > log; cd /; /try/moved/bin/odomcalibctl decode canopen:sim-dual /try/log")

    def test_the_readme_of_the_project_tells_the_two_commands(self):
        text = (source / "README.md").read_text()
        self.assertIn(f"    tar -xf {self.gz.name} && cd {self.name}\n    {self.SOLVE}\n", text)
        self.assertLess(text.index(self.SOLVE), text.index("demo.sh\n"), "before anything is built")

    def test_paths_of_its_readme_exist(self):
        for name in re.findall(r"\b(?:bin|share)/[\w./-]+|`(?:lib|licences|LICENSE)`", (self.unpacked() / "README.md").read_text()):
            self.assertTrue((self.unpacked() / name.strip("`")).exists(), name)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
