"""Rules for api/openapi.yaml. Each takes the document as the server has it and returns sentences on what is wrong."""
import re
from pathlib import Path

from json_references import references

METHODS = ("get", "put", "post", "delete", "patch")
PROBLEM = "application/problem+json"
# OpenAPI 3.1: what each object may have, and what it must.
FIELDS = {
    "document": ("openapi info servers security tags paths components", "openapi info paths"),
    "info": ("title version license summary description", "title version description license"),
    "path item": ("parameters get put post delete patch", ""),
    "operation": ("tags operationId summary description parameters requestBody responses security", "tags operationId summary responses"),
    "parameter": ("name in description required schema style explode example examples", "name in schema"),
    "body": ("description required content", "content"),
    "response": ("description headers content", "description"),
    "header": ("description required schema example", "schema"),
    "media type": ("schema example examples encoding", ""),
    "components": ("schemas responses parameters headers securitySchemes", ""),
}
STATUS_OF_NO_OPERATION = "x-answers-where-there-is-no-operation"


def resolved(document, node):
    while isinstance(node, dict) and "$ref" in node:
        target = document
        for step in node["$ref"][2:].split("/"):
            target = target[step]
        node = target
    return node


def operations(document):
    """(path item, path, method, operation)"""
    return [(item, path, method, item[method]) for path, item in document["paths"].items() for method in METHODS if method in item]


def answers(document):
    """(place, status, response) of every operation."""
    return [(f"{operation['operationId']} {status}", status, resolved(document, answer))
            for _, _, _, operation in operations(document) for status, answer in operation["responses"].items()]


def objects(document):
    """(kind, place, object) of everything that OpenAPI has a shape for."""
    yield "document", "document", document
    yield "info", "info", document["info"]
    yield "components", "components", document["components"]
    for path, item in document["paths"].items():
        yield "path item", path, item
        for parameter in item.get("parameters", []):
            yield "parameter", path, resolved(document, parameter)
    for _, _, _, operation in operations(document):
        name = operation["operationId"]
        yield "operation", name, operation
        for parameter in operation.get("parameters", []):
            yield "parameter", name, resolved(document, parameter)
        if "requestBody" in operation:
            yield "body", name, operation["requestBody"]
            yield from (("media type", name, media) for media in operation["requestBody"]["content"].values())
    for place, _, answer in answers(document):
        yield "response", place, answer
        yield from (("header", f"{place} {name}", resolved(document, header)) for name, header in answer.get("headers", {}).items())
        yield from (("media type", place, media) for media in answer.get("content", {}).values())


def objects_have_their_shape(document, _):
    for kind, place, value in objects(document):
        allowed, needed = (words.split() for words in FIELDS[kind])
        yield from (f"{place}: a {kind} has no {name!r}" for name in value if name not in allowed and not name.startswith("x-"))
        yield from (f"{place}: a {kind} needs {name!r}" for name in needed if not value.get(name))


def nothing_is_cut_at_a_comma(document, _):
    """In {flow: style} a comma ends a text without quotes, and what follows is a name without a value."""
    def walk(node, place):
        for name, value in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
            if value is None and isinstance(node, dict) and name != "default":
                yield f"{place}: {name!r} has no value; quotes are missing before it"
            elif name not in ("example", "examples"):
                yield from walk(value, f"{place}/{name}")
    yield from walk(document, "")


def operations_say_what_they_do(document, _):
    names, tags = [], {tag["name"] for tag in document["tags"] if tag.get("description")}
    for _, path, method, operation in operations(document):
        name, summary = operation.get("operationId", ""), operation.get("summary", "")
        names.append(name)
        if not re.fullmatch(r"[a-z][A-Za-z0-9]+", name):
            yield f"{method} {path}: the operationId {name!r} is not in camelCase"
        if not re.match(r"[A-Z].*[.?!]$", summary) or len(summary) > 160:
            yield f"{name}: the summary is not a sentence of at most 160 characters"
        if len(operation.get("tags", [])) != 1 or operation["tags"][0] not in tags:
            yield f"{name}: needs one tag that is described"
    yield from (f"{name}: two operations of that name" for name in set(names) if names.count(name) > 1)


def paths_have_their_parameters(document, _):
    for item, path, _, operation in operations(document):
        parameters = [resolved(document, p) for p in item.get("parameters", []) + operation.get("parameters", [])]
        declared = {p["name"] for p in parameters if p["in"] == "path"}
        if declared != set(re.findall(r"\{(\w+)\}", path)):
            yield f"{path}: its parameters are {sorted(declared)}"
        for p in parameters:
            if p["in"] == "path" and p.get("required") is not True:
                yield f"{path}: the parameter {p['name']} must be required"
            if not p.get("description"):
                yield f"{operation['operationId']}: the parameter {p['name']} is not described"


def answers_are_described(document, _):
    for place, status, answer in answers(document):
        if not answer.get("description", "").strip():
            yield f"{place}: no description"
        if not re.fullmatch(r"[1-5]\d\d", status):
            yield f"{place}: no status"
        if status in ("204", "304") and answer.get("content"):
            yield f"{place}: has no body"
        if int(status) >= 400 and PROBLEM not in answer.get("content", {}) and place != "getReadiness 503":
            yield f"{place}: an error is a problem"
    for _, _, _, operation in operations(document):
        if not any(status.startswith("2") for status in operation["responses"]):
            yield f"{operation['operationId']}: never succeeds"


def problems_have_examples(document, _):
    for name, answer in document["components"]["responses"].items():
        content = answer.get("content", {}).get(PROBLEM)
        if content is not None and "example" not in content and "examples" not in content:
            yield f"components/responses/{name}: no example"


def bodies_have_examples(document, _):
    """Requests of JSON show one: in the media type, or in its schema."""
    for _, _, _, operation in operations(document):
        for kind, media in operation.get("requestBody", {}).get("content", {}).items():
            schema = resolved(document, media.get("schema", {}))
            if kind == "application/json" and not ({"example", "examples"} & set(media) or schema.get("examples")):
                yield f"{operation['operationId']}: its {kind} has no example"


def examples_in(node, place="", schema=None):
    """(place, schema, example) wherever there is one."""
    if isinstance(node, list):
        for item in node:
            yield from examples_in(item, place)
    if not isinstance(node, dict):
        return
    if isinstance(node.get("examples"), list):  # of a schema
        yield from ((place, node, example) for example in node["examples"])
    if "schema" in node:
        if "example" in node:
            yield place, node["schema"], node["example"]
        if isinstance(node.get("examples"), dict):
            yield from ((place, node["schema"], example["value"]) for example in node["examples"].values())
    for name, item in node.items():
        if name not in ("example", "examples", "enum", "const", "default"):
            yield from examples_in(item, f"{place}/{name}")
        elif name == "default":
            yield f"{place}/default", node, item


def examples_are_valid(document, errors):
    """`errors(schema, value)`: what is wrong with the value."""
    for place, schema, example in examples_in(document):
        if "encoding" in place or "multipart" in place:
            continue  # parts are files, which an example only hints at
        yield from (f"{place}: the example {str(example)[:60]!r}: {what}" for what in errors(schema, example))


def components_are_used(document, _):
    used = set(references(document))
    for kind, members in document["components"].items():
        for name in members:
            place = f"#/components/{kind}/{name}"
            if kind != "securitySchemes" and not any(reference == place or reference.startswith(place + "/") for reference in used):
                yield f"{place}: nothing uses it"
    schemes = {name for _, _, _, operation in operations(document)
               for alternative in operation.get("security", document["security"]) for name in alternative}
    if schemes != set(document["components"]["securitySchemes"]):
        yield f"security uses {sorted(schemes)}"


def statuses_of_the_server_are_documented(document, _, root):
    text = (Path(root) / "server/http/problem.cpp").read_text()
    given = set(re.findall(r"std::pair\{(\d{3}), ", text))
    documented = {status for _, status, _ in answers(document)} | set(document[STATUS_OF_NO_OPERATION])
    errors = {status for status in documented if status >= "400"}
    yield from (f"the server answers {status}, the document does not have it" for status in sorted(given - documented))
    yield from (f"the document has {status}, the server has no title for it" for status in sorted(errors - given))


CODE_FOLDERS = ("api", "api/json", "server/http", "server/jobs", "server/archives", "server/artefacts", "engine/scene",
                "engine/animation", "engine/pipeline", "engine/worker")
# A call that says what is wrong; the code is the last plain word before the sentence.
CALL = re.compile(r"(?:add_violation|add_at_parent|violations_?\.add|violations\.add|\brefuse|refuse_part|bad_parameter|archive_refusal)\("
                  r"|\b0, 0, |\b1u, |\.code = ")
PLACES = {"archive", "parent", "lines"}  # words that such calls have for where, beside a code in a variable


def codes_in(text):
    for call in CALL.finditer(text):
        code = None
        for word in re.findall(r'"((?:[^"\\]|\\.)*)"', text[call.end():call.end() + 400].partition(";")[0]):
            if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", word):
                break
            code = word
        if code and code not in PLACES:
            yield code


def codes_of_errors_are_documented(document, _, root):
    texts = [path.read_text() for folder in CODE_FOLDERS for path in sorted((Path(root) / folder).glob("*.cpp"))]
    everywhere = [path.read_text() for folder in ("api", "server", "engine") for path in sorted((Path(root) / folder).rglob("*.[ch]*"))
                  if path.suffix in (".cpp", ".h")]
    schema = document["components"]["schemas"]["problem_document"]
    listed = {item["const"] for item in schema["$defs"]["error"]["properties"]["code"]["oneOf"]}
    used = {code for text in texts for code in codes_in(text)}
    yield from (f"the code {code!r} is not in problem.schema.json" for code in sorted(used - listed))
    yield from (f"the code {code!r} of problem.schema.json is nowhere in the sources" for code in sorted(listed)
                if not any(re.search(rf'"{code}\b', text) for text in everywhere))
    types = set(re.findall(r'"(urn:keylume:problem:[a-z-]+)"', (Path(root) / "api/json/json_text.cpp").read_text()))
    in_schema = {item["const"] for item in schema["properties"]["type"]["oneOf"]}
    yield from (f"problem type {name} is in the code or in problem.schema.json alone" for name in sorted(types ^ in_schema))


RULES = (objects_have_their_shape, nothing_is_cut_at_a_comma, operations_say_what_they_do, paths_have_their_parameters, answers_are_described,
         problems_have_examples, bodies_have_examples, examples_are_valid, components_are_used)
RULES_OF_THE_SERVER = (statuses_of_the_server_are_documented, codes_of_errors_are_documented)


def findings(document, errors, root):
    found = [f"{rule.__name__}: {what}" for rule in RULES for what in rule(document, errors)]
    return found + [f"{rule.__name__}: {what}" for rule in RULES_OF_THE_SERVER for what in rule(document, errors, root)]
