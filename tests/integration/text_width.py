"""Text for people fits a terminal as it opens."""

COLUMNS = 80
# A path or another word that nobody can break may be wider: whoever copies it wants it whole.
UNBREAKABLE = 60


def too_wide(text):
    """Lines that are wider than COLUMNS though they could have been broken."""
    return [line for line in text.splitlines()
            if len(line) > COLUMNS and max(map(len, line.split())) < UNBREAKABLE]
