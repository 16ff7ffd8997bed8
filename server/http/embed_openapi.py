#!/usr/bin/env python3
"""embed_openapi.py OPENAPI_YAML OUTPUT_CPP

The OpenAPI document as one JSON text, the schemas it refers to included, as a C++ source: a client needs a single
request to know everything, and the server no file to find.
"""
import json
import sys
from pathlib import Path

import yaml


def component(path):
    """schemas/job.schema.json -> Job_document: the name of the whole file among the components."""
    return Path(path).name.split(".")[0] + "_document"


def with_inner_references(value, home, found):
    """`value` with every $ref to another file turned into one to a component. `home`: the file that it is in."""
    if isinstance(value, list):
        return [with_inner_references(item, home, found) for item in value]
    if not isinstance(value, dict):
        return value
    result = {}
    for key, item in value.items():
        if key == "$ref" and isinstance(item, str):
            result[key] = inner_reference(item, home, found)
        elif home and key in ("$id", "$schema"):
            continue  # an $id would change what the references mean
        else:
            result[key] = with_inner_references(item, home, found)
    return result


def inner_reference(reference, home, found):
    path, _, pointer = reference.partition("#")
    target = (home.parent / path if home else Path(path)) if path else home
    if target is None:
        return reference
    found.add(target)
    return f"#/components/schemas/{component(target)}{pointer}"


def with_common_answers(document):
    """What every operation may answer, written once in the source, in every operation."""
    common = document.pop("x-answers-of-every-operation", {})
    document.pop("x-scopes", None)  # its lists stand where they are used
    for item in document["paths"].values():
        for method, operation in item.items():
            if method != "parameters":
                operation["responses"] = {**common, **{str(status): answer for status, answer in operation["responses"].items()}}
                if method == "get":
                    add_polling(operation["responses"])
    return document


def add_polling(answers):
    """JSON that is asked for has a tag, so that asking again costs a 304."""
    whole = answers["200"]
    if "application/json" in whole.get("content", {}):
        whole.setdefault("headers", {}).setdefault("ETag", {"description": "Changes with the content.", "schema": {"type": "string"}})
        answers.setdefault("304", {"$ref": "#/components/responses/Unchanged"})


def bundled(openapi):
    document = with_common_answers(yaml.safe_load(openapi.read_text()))
    found, done = set(), set()
    document = with_inner_references(document, None, found)
    while found - done:
        path = sorted(found - done)[0]
        done.add(path)
        schema = json.loads((openapi.parent / path).read_text())
        document["components"]["schemas"][component(path)] = with_inner_references(schema, path, found)
    return document


def main():
    source, output = Path(sys.argv[1]), Path(sys.argv[2])
    text = json.dumps(bundled(source), ensure_ascii=True, separators=(",", ":"))
    # In pieces: compilers limit the length of one literal.
    pieces = "\n".join(f'    R"json({text[at:at + 8000]})json"' for at in range(0, len(text), 8000))
    output.write_text("// Generated from api/openapi.yaml and api/schemas/.\n"
                      '#include "server/http/routes.h"\n\nnamespace server {\n\n'
                      f"std::string_view openapi_json() {{\n  return\n{pieces};\n}}\n\n}}  // namespace server\n")


if __name__ == "__main__":
    main()
