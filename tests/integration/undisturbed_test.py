"""What `undisturbed` makes of a test that fails once, with and without a machine that stood still.

usage: undisturbed_test.py
"""
import pathlib
import subprocess
import tempfile
import unittest

UNDISTURBED = pathlib.Path(__file__).with_name("undisturbed")
ALWAYS, NEVER = "0", "1e9"  # s, of standing still that counts: what every sleeper sees, and none


class Undisturbed(unittest.TestCase):
    def run_it(self, pause, last_failure):
        """Exit status and number of attempts of a command that fails with 3 up to this attempt."""
        with tempfile.NamedTemporaryFile() as attempts:
            script = f'echo >> {attempts.name}; test $(wc -l < {attempts.name}) -gt {last_failure} || exit 3'
            command = [UNDISTURBED, "--pause", pause, "sh", "-c", script]
            status = subprocess.run(command, stdout=subprocess.DEVNULL).returncode
            return status, len(attempts.readlines())

    def test_what_passes_runs_once(self):
        self.assertEqual(self.run_it(ALWAYS, 0), (0, 1))

    def test_what_fails_on_a_machine_that_went_on_has_failed(self):
        self.assertEqual(self.run_it(NEVER, 1), (3, 1))

    def test_what_fails_on_a_machine_that_stood_still_runs_again(self):
        self.assertEqual(self.run_it(ALWAYS, 1), (0, 2))

    def test_what_always_fails_has_failed_after_three_attempts(self):
        self.assertEqual(self.run_it(ALWAYS, 9), (3, 3))


if __name__ == "__main__":
    unittest.main()
