"""Text for people fits a terminal as it opens."""

import fcntl
import os
import pty
import struct
import subprocess
import termios

COLUMNS = 80
# A path or another word that nobody can break may be wider: whoever copies it wants it whole.
UNBREAKABLE = 60


def too_wide(text):
    """Lines that are wider than COLUMNS though they could have been broken."""
    return [line for line in text.splitlines()
            if len(line) > COLUMNS and max(map(len, line.split())) < UNBREAKABLE]


def shown_on_terminal(command, folder, with_results=False):
    """Messages of a command whose terminal has COLUMNS, and its results where they are wanted; without what it takes back."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, COLUMNS, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=theirs if with_results else subprocess.DEVNULL,
                          stderr=theirs, env=environment):
        os.close(theirs)
        seen = b""
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:  # the program has ended
                break
            if not part:
                break
            seen += part
    os.close(ours)
    lines = seen.decode().replace("\r\n", "\n").split("\n")
    return "\n".join(line.rsplit("\r\x1b[K", 1)[-1] for line in lines)
