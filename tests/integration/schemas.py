"""The published schemas of what odomcalibctl prints, and whether documents keep to them."""

import copy
import json
import os

import jsonschema

WRONG = {"no such member": "no such text"}


class Schemas:
    def __init__(self, folder):
        self._validators = {}
        for file_name in sorted(os.listdir(folder)):
            name = file_name.removesuffix("-1.json")
            with open(os.path.join(folder, file_name), encoding="utf-8") as file:
                schema = json.load(file)
            jsonschema.Draft202012Validator.check_schema(schema)
            if schema["$id"] != "urn:odomcalib:schema:%s:1" % name:
                raise ValueError("%s: $id is %s" % (file_name, schema["$id"]))
            self._validators[name] = jsonschema.Draft202012Validator(schema)

    def names(self):
        return set(self._validators)

    def faults(self, document, name):
        """What of the document is not as published; of a right one, what would be wrong with it and is let pass."""
        validator = self._validators[name]
        found = ["%s: %s: %s" % (name, "/".join(map(str, error.path)), error.message[:300])
                 for error in validator.iter_errors(document)]
        if not found and isinstance(document, dict):
            found = ["%s: %s is let pass" % (name, what) for what, spoiled in spoiled_copies(document, validator.schema)
                     if validator.is_valid(spoiled)]
        return found


def spoiled_copies(document, schema):
    """The document with one thing wrong: another version, a member too many or too few, a member of another type."""
    if "properties" not in schema:  # one of several kinds of lines; their type is what is ours
        yield "another type", {**document, "type": "no such type"}
        return
    if "format" in document:
        yield "another version", {**document, "format": document["format"] + "0"}
    if schema.get("additionalProperties") is False:
        yield "an unknown member", {**document, **WRONG}
    for member in document:
        yield member + " of another type", {**copy.deepcopy(document), member: WRONG}
        if member in schema["required"]:
            yield "a document without " + member, {key: value for key, value in document.items() if key != member}
