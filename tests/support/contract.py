"""api/openapi.yaml as a judge: is this answer one that the document allows for this request?

Needs python3-jsonschema and python3-yaml.
"""
import gzip
import importlib.util
import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qsl, unquote

import jsonschema

ROOT = Path(__file__).resolve().parents[2]
PROBLEM = "application/problem+json"
# Of HTTP itself, and of every answer alike; what they mean is not for this document to say.
HTTP_HEADERS = {"accept-ranges", "allow", "cache-control", "connection", "content-length", "content-range",
                "content-type", "date", "keep-alive", "server", "transfer-encoding"}


def bundled():
    """The document as the server has it in /openapi.json."""
    spec = importlib.util.spec_from_file_location("embed_openapi", ROOT / "server/http/embed_openapi.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.bundled(ROOT / "api/openapi.yaml")


@dataclass
class Exchange:
    """A request and what came back. `path` with its query, as sent; header names of the answer in lower case."""
    method: str
    path: str
    status: int
    headers: dict
    body: bytes
    request_body: bytes = None
    is_whole: bool = True  # False: a stream that was left before its end


@dataclass
class Operation:
    name: str
    method: str
    template: str
    parameters: list
    request_body: dict
    responses: dict
    security: list
    tags: list = field(default_factory=list)


FORMATS = jsonschema.FormatChecker(formats=())


@FORMATS.checks("date-time")
def is_date_time(value):
    return not isinstance(value, str) or bool(re.fullmatch(
        r"\d{4}-(0[1-9]|1[0-2])-([0-2]\d|3[01])T([01]\d|2[0-3]):[0-5]\d:([0-5]\d|60)(\.\d+)?(Z|[+-]\d\d:\d\d)", value))


@FORMATS.checks("uri")
def is_uri(value):
    return not isinstance(value, str) or bool(re.fullmatch(r"[a-z][a-z0-9+.-]*:\S+", value))


def media_type_of(text):
    return text.partition(";")[0].strip().lower()


def from_text(text, schema):
    """A header's or parameter's value as the schema's type; the text itself where it is none of them."""
    for kind in (schema, *schema.get("anyOf", [])):
        types = kind.get("type", [])
        types = [types] if isinstance(types, str) else types
        if "integer" in types and re.fullmatch(r"-?\d+", text):
            return int(text)
        if "number" in types:
            try:
                return float(text)
            except ValueError:
                continue
        if "boolean" in types and text in ("true", "false"):
            return text == "true"
    return text


def values_of(pattern, segments):
    """Of the {names} in a path's pattern; None where the path is another one."""
    values = {}
    for wanted, given in zip(pattern, segments):
        name, _, ending = wanted[1:].partition("}")
        if not wanted.startswith("{"):
            if wanted != given:
                return None
        elif len(given) <= len(ending) or not given.endswith(ending):
            return None
        else:
            values[name] = given.removesuffix(ending)
    return values


class Contract:
    def __init__(self, document=None):
        self.document = document or bundled()
        self.validators = {}
        self.operations = [operation for template, item in self.document["paths"].items()
                           for operation in self.operations_at(template, item)]
        self.by_name = {operation.name: operation for operation in self.operations}

    def operations_at(self, template, item):
        for method, given in item.items():
            if method == "parameters":
                continue
            parameters = [self.resolved(p) for p in item.get("parameters", []) + given.get("parameters", [])]
            responses = {status: self.resolved(answer) for status, answer in given["responses"].items()}
            yield Operation(given["operationId"], method.upper(), template, parameters, given.get("requestBody"), responses,
                            given.get("security", self.document.get("security", [])), given.get("tags", []))

    def resolved(self, node):
        while isinstance(node, dict) and "$ref" in node:
            target = self.document
            for step in node["$ref"][2:].split("/"):
                target = target[step.replace("~1", "/").replace("~0", "~")]
            node = target
        return node

    def errors(self, schema, value):
        """Sentences, at most five, on what is wrong with `value`."""
        key = json.dumps(schema, sort_keys=True)
        if key not in self.validators:
            whole = {**schema, "components": self.document["components"]}
            self.validators[key] = jsonschema.Draft202012Validator(whole, format_checker=FORMATS)
        found = sorted(self.validators[key].iter_errors(value), key=lambda error: str(error.absolute_path))[:5]
        return [f"/{'/'.join(map(str, error.absolute_path))}: {error.message[:300]}" for error in found]

    def find(self, method, path):
        """-> operation and the values of its path; None where the document has no such operation."""
        segments = [unquote(segment, errors="replace") for segment in path.partition("?")[0].split("/")]
        wanted = "GET" if method == "HEAD" else method
        best = None
        for operation in self.operations:
            pattern = operation.template.split("/")
            if operation.method != wanted or len(pattern) != len(segments):
                continue
            values = values_of(pattern, segments)
            if values is not None and (best is None or len(values) < len(best[1])):
                best = operation, values
        return best

    def problems(self, exchange):
        """What the document does not allow about this exchange; empty: nothing."""
        found = self.find(exchange.method, exchange.path)
        if not found:
            return self.problems_elsewhere(exchange)
        operation, values = found
        answer = operation.responses.get(str(exchange.status)) or self.of_no_operation(exchange)
        if answer is None or exchange.status == 500:
            return [f"{operation.name}: status {exchange.status} is not in the document: {exchange.body[:300]!r}"]
        wrong = self.wrong_headers(answer, exchange) + self.wrong_body(answer, exchange)
        if 200 <= exchange.status < 300:
            wrong += [f"accepted although {what}" for what in self.wrong_request(operation, values, exchange)]
        return [f"{operation.name} {exchange.status}: {what}" for what in wrong]

    def problems_elsewhere(self, exchange):
        """Of a request that no operation is for."""
        every = self.by_name["getJob"].responses  # among them those that any operation may give
        given = {**every, **self.document["x-answers-where-there-is-no-operation"]}
        answer = self.resolved(given.get(str(exchange.status), {}))
        if exchange.status < 400 or not answer:
            return [f"status {exchange.status} where the document has no operation"]
        return self.wrong_headers(answer, exchange) + self.wrong_body(answer, exchange)

    def of_no_operation(self, exchange):
        """What is refused before anybody looks which operation it is."""
        if exchange.status in (404, 405):
            return None
        return self.resolved(self.document["x-answers-where-there-is-no-operation"].get(str(exchange.status)))

    def wrong_headers(self, answer, exchange):
        wrong, known = [], {}
        for name, header in {**answer.get("headers", {}), **self.headers_of_every_answer()}.items():
            header = known[name.lower()] = self.resolved(header)
            if name.lower() not in exchange.headers:
                if header.get("required"):
                    wrong.append(f"the header {name} is missing")
                continue
            value = from_text(exchange.headers[name.lower()], header["schema"])
            wrong += [f"the header {name}: {what}" for what in self.errors(header["schema"], value)]
        return wrong + [f"the header {name} is not in the document" for name in exchange.headers
                        if name not in known and name not in HTTP_HEADERS]

    def headers_of_every_answer(self):
        return self.document.get("x-headers-of-every-answer", {})

    def wrong_body(self, answer, exchange):
        content = answer.get("content")
        if not content or exchange.status in (204, 304):
            return ["there is a body, and the document has none"] if exchange.body else []
        given = media_type_of(exchange.headers.get("content-type", ""))
        if given not in content:
            return [f"the content type {given!r} is not in the document"]
        if exchange.method == "HEAD":
            return ["the answer to HEAD has a body"] if exchange.body else []
        schema = content[given].get("schema")
        if exchange.status == 206 or not schema or not given.endswith("json"):
            return []
        try:
            packed = exchange.headers.get("content-encoding") == "gzip"
            value = json.loads(gzip.decompress(exchange.body) if packed else exchange.body)
        except (ValueError, EOFError, gzip.BadGzipFile) as error:
            return [f"the body is no JSON: {error}"] if exchange.is_whole else []
        wrong = self.errors(schema, value)
        if given == PROBLEM and isinstance(value, dict) and value.get("status") != exchange.status:
            wrong.append(f"the problem's status is {value.get('status')}")
        return wrong

    def wrong_request(self, operation, values, exchange):
        """What was wrong with a request that was accepted all the same."""
        query = parse_qsl(exchange.path.partition("?")[2], keep_blank_values=True, errors="replace")
        given = {"path": list(values.items()), "query": query}
        for parameter in operation.parameters:
            schema = parameter["schema"]
            schema = schema.get("items", schema)
            for name, text in given.get(parameter["in"], []):
                if name == parameter["name"]:
                    yield from (f"{name} is {text[:100]!r}: {what}" for what in self.errors(schema, from_text(text, self.resolved(schema))))
        content = (operation.request_body or {}).get("content", {})
        if "application/json" not in content or "multipart/form-data" in content or exchange.request_body is None:
            return
        if not exchange.request_body and not operation.request_body.get("required"):
            return
        try:
            body = json.loads(exchange.request_body)
        except ValueError:
            yield "the body is no JSON"
            return
        yield from (f"the body is not as it should be, {what}" for what in self.errors(content["application/json"]["schema"], body))
