"""What the built packages hold: check_packages.py PACKAGE_FOLDER SOURCE_FOLDER"""

import gzip
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

packages, source = (pathlib.Path(argument) for argument in sys.argv[1:3])


def told(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def cmake_version():
    return re.search(r"project\(odomcalib VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text())[1]


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = tempfile.TemporaryDirectory()
        cls.files = {}
        for deb in packages.glob("*.deb"):
            name = told("dpkg-deb", "-f", deb, "Package").strip()
            cls.files[name] = deb
            if not name.endswith("-dbgsym"):
                subprocess.run(["dpkg-deb", "-x", deb, cls.root.name], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.root.cleanup()

    def field(self, package, name):
        return told("dpkg-deb", "-f", self.files[package], name).strip()

    def installed(self, path):
        return pathlib.Path(self.root.name) / path

    def test_there_is_one_for_the_service_the_tools_and_development(self):
        self.assertLessEqual({"odomcalibd", "odomcalib", "odomcalib-dev"}, set(self.files))
        self.assertLessEqual({"libodomcalib0", "libodomcalib-dev", "python3-odomcalib"}, set(self.files))

    def test_the_library_needs_the_runtime_and_its_module_the_library(self):
        depends = [word.split()[0] for word in self.field("libodomcalib0", "Depends").split(", ")]
        self.assertEqual(sorted(depends), ["libc6", "libgcc-s1", "libstdc++6"])
        self.assertIn("libodomcalib0 (>= 0.2", self.field("python3-odomcalib", "Depends"))
        folder = self.installed("usr/lib/python3/dist-packages")
        library = next(self.installed("usr/lib").glob("*/libodomcalib.so.0"))
        told("env", f"PYTHONPATH={folder}", f"ODOMCALIB_LIBRARY={library.parent}", "/usr/bin/python3", "-c",
             f"import odomcalib; assert odomcalib.version() == '{cmake_version()}'")
        for path in ("usr/include/odomcalib/odometry.h", "usr/include/odomcalib/odometry.hpp",
                     "usr/share/doc/libodomcalib-dev/examples/control_loop.c"):
            self.assertTrue(self.installed(path).exists(), path)

    def test_their_version_is_that_of_the_program(self):
        for package in ("odomcalibd", "odomcalib", "odomcalib-dev"):
            self.assertEqual(self.field(package, "Version"), cmake_version())
        for program in ("odomcalibd", "odomcalibctl"):
            self.assertEqual(told(self.installed(f"usr/bin/{program}"), "--version").strip(), cmake_version())

    def test_they_need_libraries_and_no_development_files(self):
        for package in ("odomcalibd", "odomcalib"):
            depends = self.field(package, "Depends")
            self.assertIn("libssl3", depends)
            self.assertNotRegex(depends, r"-dev\b")
        self.assertIn(f"odomcalib (= {cmake_version()})", self.field("odomcalibd", "Depends"))

    def test_the_configuration_is_a_conffile(self):
        told("dpkg-deb", "-e", self.files["odomcalibd"], pathlib.Path(self.root.name) / "DEBIAN")
        self.assertEqual(self.installed("DEBIAN/conffiles").read_text().split(), ["/etc/odomcalib/odomcalib.toml"])

    def test_the_paths_in_the_files_exist(self):
        for path in ("etc/odomcalib/odomcalib.toml", "lib/systemd/system/odomcalib.service"):
            for name in re.findall(r"/usr/[\w./-]+", self.installed(path).read_text()):
                self.assertTrue(self.installed(name[1:]).exists(), f"{name} in {path}")
        self.assertIn("/etc/odomcalib/odomcalib.toml", told(self.installed("usr/bin/odomcalibd"), "--help"))
        self.assertIn("/usr/share/odomcalib/profiles", told(self.installed("usr/bin/odomcalibctl"), "decode", "--help"))

    def test_relative_links_of_the_documents_resolve(self):
        folder, links = self.installed("usr/share/doc/odomcalib"), 0
        for page in folder.glob("**/*.md"):
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
                links += 1
                self.assertTrue((page.parent / link).exists(), f"{page.relative_to(folder)}: {link}")
        self.assertGreater(links, 100)
        self.assertTrue((folder / "README.md").exists())

    def test_the_simulator_of_recordings_is_there(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder) / "rest.jsonl.gz"
            told(self.installed("usr/bin/odomcalib-sim-record"), "--drive", "rest", "--duration", "2", "--out", recording)
            self.assertEqual(json.loads(gzip.open(recording, "rt").readline())["type"], "robot")

    def test_every_manual_page_is_there(self):
        for page in (source / "docs/man").iterdir():
            self.assertTrue(self.installed(f"usr/share/man/man{page.suffix[1:]}/{page.name}.gz").exists(), page.name)

    def test_bindings_can_be_made_from_the_types(self):
        types = sorted(str(path) for path in self.installed("usr/share/odomcalib/lcm").iterdir())
        self.assertEqual([pathlib.Path(path).name for path in types],
                         sorted(path.name for path in source.glob("proto/**/*.lcm")))
        with tempfile.TemporaryDirectory() as folder:
            told("lcm-gen", "--python", "--ppath", folder, *types)
            self.assertTrue((pathlib.Path(folder) / "odomcalib/scan_t.py").exists())
        interface = self.installed("usr/share/odomcalib/varlink/org.odomcalib.Calibration.varlink").read_text()
        self.assertIn("interface org.odomcalib.Calibration", interface)

    def test_the_shells_look_where_their_completion_is(self):
        looks = {"usr/share/fish/vendor_completions.d/odomcalibctl.fish":
                 told("fish", "--command", "string join \\n $fish_complete_path"),
                 "usr/share/zsh/vendor-completions/_odomcalibctl": told("zsh", "-fc", "print -l $fpath"),
                 # As its documentation says: without the package nobody can be asked.
                 "usr/share/bash-completion/completions/odomcalibctl": "/usr/share/bash-completion/completions"}
        for path, folders in looks.items():
            self.assertTrue(self.installed(path).exists(), path)
            self.assertIn("/" + str(pathlib.PurePath(path).parent), folders.split())

    def test_every_json_schema_is_there(self):
        schemas = {path.name for path in (source / "docs/schema").iterdir()}
        self.assertEqual({path.name for path in self.installed("usr/share/odomcalib/schema").iterdir()}, schemas)

    def test_the_sample_is_small_and_solved_by_the_first_command_of_the_readme(self):
        sample = self.installed("usr/share/odomcalib/examples/drive.jsonl.gz")
        self.assertLess(sample.stat().st_size, 600_000)
        self.assertEqual(json.loads(gzip.open(sample, "rt").readline())["type"], "robot")
        command = re.search(r"^ +odomcalibctl (solve /usr/share/odomcalib/examples/\S+.*)$",
                            (source / "README.md").read_text(), re.M)
        self.assertIsNotNone(command, "README.md solves the sample")
        words = command[1].split("#")[0].replace("/usr/", f"{self.root.name}/usr/").split()
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([self.installed("usr/bin/odomcalibctl"), *words], cwd=folder, check=False,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertTrue((pathlib.Path(folder) / "report.html").exists())

    def test_the_example_of_a_robot_file_is_taken(self):
        sample = self.installed("usr/share/odomcalib/examples/drive.jsonl.gz")
        with tempfile.TemporaryDirectory() as folder:
            for robot in ("usr/share/odomcalib/examples/robot.toml", "etc/odomcalib/odomcalib.toml"):
                told(self.installed("usr/bin/odomcalibctl"), "predict", sample, "--robot", self.installed(robot),
                     "--calibration", "nominal", "--trajectory", pathlib.Path(folder) / "out.tum")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
