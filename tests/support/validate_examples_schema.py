#!/usr/bin/env python3
"""The schemas are schemas, the examples match them, and openapi.yaml refers to nothing that is missing.

Needs the packages python3-jsonschema and python3-yaml.
"""

import json
import pathlib
import sys

import jsonschema
import yaml

from json_references import references

API = pathlib.Path(__file__).resolve().parents[2] / "api"
EXAMPLES = API / "examples"


def schema(name):
    return json.loads((API / "schemas" / f"{name}.schema.json").read_text(encoding="utf-8"))


def resolve(reference, document):
    file, _, pointer = reference.partition("#")
    target = json.loads((API / file).read_text(encoding="utf-8")) if file else document
    for step in pointer.split("/")[1:]:
        target = target[step]


def check_openapi():
    document = yaml.safe_load((API / "openapi.yaml").read_text(encoding="utf-8"))
    names = [operation["operationId"] for path in document["paths"].values()
             for verb, operation in path.items() if verb != "parameters"]
    assert len(names) == len(set(names)) and len(names) >= 19, names
    for reference in references(document):
        resolve(reference, document)
    for name, part in document["components"]["schemas"].items():
        jsonschema.Draft202012Validator.check_schema(part)


def errors(validator, value):
    return [f"/{'/'.join(map(str, error.absolute_path))}: {error.message[:200]}" for error in validator.iter_errors(value)]


def main():
    for path in sorted((API / "schemas").iterdir()):
        jsonschema.Draft202012Validator.check_schema(json.loads(path.read_text(encoding="utf-8")))
    job = jsonschema.Draft202012Validator(schema("job"))
    accepted = sorted(path for path in EXAMPLES.glob("*/animation*.json"))
    assert len(accepted) >= 3
    wrong = {str(path): found for path in accepted if (found := errors(job, json.loads(path.read_text())))}

    # Of what is refused, the schema sees all but what needs more than one value (or the OBJ) to be seen.
    beyond = {"not_increasing", "unknown_camera", "unknown_object", "unknown_material", "unknown_light", "unknown_parent",
              "cycle", "no_light", "limit_exceeded", "not_affine", "duplicate_key", "syntax", "too_deep"}
    problem = jsonschema.Draft202012Validator(schema("problem"))
    for folder in sorted(path for path in (EXAMPLES / "rejected").iterdir() if path.is_dir()):
        expected = json.loads((folder / "expected.json").read_text())
        full = {"type": "urn:keylume:problem:invalid-request", "title": "", "status": expected["status"],
                "errors": [{**error, "detail": ""} for error in expected["errors"]]}
        if found := errors(problem, full):
            wrong[str(folder / "expected.json")] = found
        ours = [error for error in expected["errors"] if error["file"] == "animation.json"]
        if ours and not {error["code"] for error in ours} <= beyond:
            if not errors(job, json.loads((folder / "animation.json").read_text())):
                wrong[str(folder)] = ["the schema accepts it"]
    check_openapi()
    for path, found in wrong.items():
        print(path, *found, sep="\n  ")
    sys.exit(1 if wrong else 0)


main()
