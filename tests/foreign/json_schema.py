"""Validates JSON objects, one per line of stdin, by the schemas of a folder. Their key `schema` chooses."""

import json
import pathlib
import sys

import jsonschema

folder = pathlib.Path(sys.argv[1])
for line in sys.stdin:
    document = json.loads(line)
    schema = json.loads((folder / f"{document['schema']}.json").read_text())
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    # Schemas permit keys that they do not list, but the program has no such keys.
    listed = set(schema["properties"])
    for part in schema["allOf"]:
        pending = [schema["$defs"][part["$ref"].rpartition("/")[2]]]
        while pending:
            definition = pending.pop()
            listed |= set(definition.get("properties", {}))
            for other in definition.get("allOf", []):
                pending.append(schema["$defs"][other["$ref"].rpartition("/")[2]] if "$ref" in other else other)
    extra = set(document) - listed
    assert not extra, f"{document['schema']} does not list {extra}"
    validator.validate(document)
    print(document["schema"])
