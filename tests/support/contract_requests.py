"""Requests made from the operations of the OpenAPI document: about half of them valid, the others with something wrong."""
import io
import json
import zipfile
from dataclasses import dataclass, field
from urllib.parse import quote

from contract_values import ODD_TEXTS, Values, broken_text, mutated

ODD_SEGMENTS = ["-1", "0x1", "1e3", "99999999999999999999", "%00", "%2e%2e", "..%2f..", "a%0d%0ab", "%ff", "%", "%zz", "x" * 65, "x" * 3000,
                "é", "'", '"', "{id}", "*", "~", "a b", "null", "1;2", "%F0%9F%98%80", "+1", "007", "1.0"]
# Of HTTP in general: any operation may be asked with these.
GENERAL_HEADERS = {
    "If-None-Match": ["*", '"x"', 'W/"x"', '"a", "b"', "x", "", '"', ",,,", '"' + "e" * 2000 + '"'],
    "Range": ["bytes=0-9", "bytes=-5", "bytes=5-", "bytes=9999999999-", "bytes=0-0,2-3", "bytes=9-1", "bytes=", "bytes=-", "lines=1-2",
              "bytes=-0", "bytes=99999999999999999999-", "bytes=0-99999999999999999999", "bytes=a-b", "=", "bytes=--1"],
    "If-Range": ['"x"', "Wed, 21 Oct 2026 07:28:00 GMT", ""],
    "Accept": ["*/*", "application/json", "image/*;q=0.1", "nonsense", ""],
    "Accept-Encoding": ["gzip", "br, gzip;q=0", "identity;q=0"],
    "Origin": ["null", "http://example.com", "x"],
    "Cookie": ["keylume_token=x", "a=b; keylume_token=", ";;;", "keylume_token"],
    "Authorization": ["Bearer x", "Bearer ", "Basic eDp5", "bearer", "kl_"],
    "X-Request-Id": ["a-1", "x" * 65, "a b", "", "é"],
    "X-Forwarded-For": ["1.2.3.4", "::1, x", ""],
    "Content-Encoding": ["gzip", "identity", "deflate"],
    "Host": ["example.com", "localhost:1", "[::1]", "127.0.0.1.example.com", ""],
    "If-Match": ['"1"', "*", '"999-1"', "x", "", '"', 'W/"1"'],
    "Last-Event-ID": ["0", "-1", "x", "99999999999", "99999999999999999999", ""],
    "Idempotency-Key": ["a", "", "x" * 255, "x" * 256, "é", "a b"],
    # Not more: while the queue is paused nothing ends, and the request would wait that long.
    "Prefer": ["wait=0", "wait=1", "wait=-1", "wait=x", "respond-async", "wait", "wait=1;x, wait=0", ",;,"],
    "Expect": ["100-continue", "something"],
    "Content-Length": ["-1", "x", "1e3", "99999999999999999999"],
    "Transfer-Encoding": ["identity", "gzip, chunked", "x"],
    "X-" + "y" * 300: ["z" * 6000, "z" * 9000],
}
# Those whose body then is not what the header says: the connection is of no more use.
FRAMING = {"Content-Length", "Transfer-Encoding", "Expect"}


@dataclass
class Request:
    operation: object
    method: str
    path: str
    headers: list = field(default_factory=list)  # (name, value)
    body: bytes = None
    is_mutated: bool = False

    def curl(self, url):
        words = ["curl -sS -i --path-as-is", "-X " + self.method if self.method != "HEAD" else "-I"]
        words += [f"-H {shell_quoted(f'{name}: {value}')}" for name, value in self.headers]
        if self.body is None:
            return " ".join([*words, shell_quoted(url + self.path)])
        octal = "".join(chr(byte) if 32 <= byte < 127 and byte not in b"\\'%" else f"\\{byte:03o}" for byte in self.body)
        return f"printf '{octal}' | " + " ".join([*words, "--data-binary @-", shell_quoted(url + self.path)])


def shell_quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


class Requests:
    """`world`: which jobs there are, contract_world.World."""

    def __init__(self, contract, world):
        self.contract, self.world = contract, world
        self.values = Values(contract.resolved)

    def make(self, rng, operation, mutated_share=0.5):
        request = Request(operation, operation.method, "", is_mutated=rng.random() < mutated_share)
        request.path = self.path(rng, operation, request) + self.query(rng, operation, request)
        for parameter in operation.parameters:
            if parameter["in"] == "header" and rng.random() < 0.5:
                request.headers.append((parameter["name"], self.header(rng, parameter, request)))
        self.add_body(rng, operation, request)
        if request.is_mutated or operation.method == "GET":
            self.add_general_headers(rng, request)
        if operation.method == "GET" and rng.random() < 0.1:
            request.method = "HEAD"
        self.world.spare(request)
        return request

    def path(self, rng, operation, request):
        segments = []
        for segment in operation.template.split("/"):
            if segment.startswith("{"):
                odd = request.is_mutated and rng.random() < 0.3
                name, _, ending = segment[1:].partition("}")
                segment = rng.choice(ODD_SEGMENTS) if odd else self.world.path_value(rng, name, operation)
                segment = quote(segment, safe="%" if odd else "") + ending
            segments.append(segment)
        path = "/".join(segments)
        if request.is_mutated and rng.random() < 0.03:
            path = rng.choice([path + "/", path + "/x", "/" + path, path.upper(), path + ".json", path * 200, path + "%20"])
        return path

    def query(self, rng, operation, request):
        pairs = []
        for parameter in operation.parameters:
            if parameter["in"] == "query" and rng.random() < 0.5:
                schema = parameter["schema"]
                values = self.values.valid(rng, schema)
                if parameter["name"] == "camera" and rng.random() < 0.8:
                    values = self.world.camera
                for value in values if isinstance(values, list) else [values]:
                    text = json.dumps(value) if not isinstance(value, str) else value
                    if request.is_mutated and rng.random() < 0.5:
                        text = rng.choice(ODD_TEXTS)
                    pairs.append((parameter["name"], text))
        if request.is_mutated and rng.random() < 0.3:
            pairs.append((rng.choice(["x", "limit", "a[]", "", "é"]), rng.choice(ODD_TEXTS)))
        if request.is_mutated and pairs and rng.random() < 0.2:
            pairs *= rng.choice([2, 20])
        if request.is_mutated and rng.random() < 0.05:
            return rng.choice(["?", "?&&&", "?=", "?%", "?a=%zz", "?" + "x=1&" * 300, "??", "?limit", "?limit=1=2"])
        return "?" + "&".join(f"{quote(name)}={quote(text)}" for name, text in pairs) if pairs else ""

    def header(self, rng, parameter, request):
        if request.is_mutated or parameter["name"] in ("Prefer", "If-Match"):
            return rng.choice(GENERAL_HEADERS[parameter["name"]])
        if parameter["name"] == "Idempotency-Key":
            return f"key-{rng.randrange(40)}"
        return str(self.values.valid(rng, parameter["schema"]))

    def add_general_headers(self, rng, request):
        for _ in range(rng.choice([0, 1, 1, 2])):
            name = rng.choice(list(GENERAL_HEADERS))
            if not request.is_mutated and name not in ("If-None-Match", "Range", "If-Range", "Accept"):
                continue
            if name in FRAMING and rng.random() < 0.5:
                continue
            value = rng.choice(GENERAL_HEADERS[name])
            if name == "If-None-Match" and rng.random() < 0.7:
                value = self.world.etags.get(request.path, value)
            request.headers.append((name, value))

    def add_body(self, rng, operation, request):
        content = (operation.request_body or {}).get("content", {})
        if not content:
            if request.is_mutated and rng.random() < 0.1:
                request.body = rng.choice([b"", b"{}", b"x" * 100, b"\x00" * 5000])
            return
        if not operation.request_body.get("required") and rng.random() < 0.3:
            return
        kind = rng.choice([*content] + ["multipart/form-data"] * 2 * ("multipart/form-data" in content))
        if kind == "multipart/form-data":
            return self.add_multipart(rng, request)
        if kind == "application/octet-stream":
            request.body = self.world.blob_body(rng, request)
        else:
            request.body = self.json_body(rng, operation, content[kind]["schema"], request)
        if request.is_mutated and rng.random() < 0.1:
            request.body = None if rng.random() < 0.5 else b"z" * (3 << 20)
        if not (request.is_mutated and rng.random() < 0.2):
            request.headers.append(("Content-Type", kind))
        elif rng.random() < 0.8:
            request.headers.append(("Content-Type", rng.choice(["text/plain", "multipart/form-data", "multipart/form-data; boundary=", "x",
                                                                "", "application/json; charset=latin-1", "multipart/form-data; boundary=a",
                                                                "application/x-www-form-urlencoded", "*/*", "a/b;" * 50])))

    def json_body(self, rng, operation, schema, request):
        value = self.world.body(rng, operation) or self.values.valid(rng, schema)
        how = rng.random() if request.is_mutated else 1
        for _ in range(rng.choice([1, 1, 2, 5]) if how < 0.7 else 0):
            value = mutated(rng, value)
        text = json.dumps(value, ensure_ascii=rng.random() < 0.5)
        return broken_text(rng, text) if how < 0.2 else text.encode("utf-8", "surrogatepass")

    def add_multipart(self, rng, request):
        parts = self.world.parts(rng)
        if rng.random() < 0.15:
            parts = [("archive", "job.zip", "application/zip", zipped(parts))] + [part for part in parts if part[0] == "options"]
        if rng.random() < 0.5:
            options = self.values.valid(rng, {"$ref": "#/components/schemas/job_options_document"})
            options.pop("ttl_seconds", None)
            parts.append(("options", None, "application/json", json.dumps(options).encode()))
        boundary = "----keylume" + str(rng.randrange(10**9))
        if request.is_mutated:
            parts = wrong_parts(rng, parts)
        request.body = multipart(parts, boundary)
        if request.is_mutated and rng.random() < 0.4:
            request.body = broken_multipart(rng, request.body)
        kind = f"multipart/form-data; boundary={boundary}"
        if request.is_mutated and rng.random() < 0.1:
            kind = rng.choice(["multipart/form-data", kind + "x", "multipart/mixed; boundary=" + boundary, 'multipart/form-data; boundary="',
                               "multipart/form-data; boundary=" + "b" * 100, "application/json", "text/plain", ""])
        request.headers.append(("Content-Type", kind))


def zipped(parts):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for field_name, name, _, data in parts:
            archive.writestr({"scene": "scene.obj", "animation": "animation.json", "options": "options.json"}.get(field_name, name), data)
    return file.getvalue()


def multipart(parts, boundary):
    out = b""
    for field_name, file_name, kind, data in parts:
        file = f'; filename="{file_name}"' if file_name is not None else ""
        head = f'--{boundary}\r\nContent-Disposition: form-data; name="{field_name}"{file}\r\nContent-Type: {kind}\r\n\r\n'
        out += head.encode("utf-8", "surrogatepass") + data + b"\r\n"
    return out + f"--{boundary}--\r\n".encode()


def wrong_parts(rng, parts):
    """One part dropped, doubled, renamed, of another name or with other content."""
    parts = list(parts)
    at = rng.randrange(len(parts))
    name, file_name, kind, data = parts[at]
    how = rng.randrange(7)
    if how == 0:
        del parts[at]
    elif how == 1:
        parts += [parts[at]] * rng.choice([1, 30])
    elif how == 2:
        parts[at] = (rng.choice(["x", "", "Scene", "scene[]", "é", "a" * 300, "options", "archive"]), file_name, kind, data)
    elif how == 3:
        parts[at] = (name, rng.choice(["", "../x.mtl", "scene.obj", "C:\\x.mtl", ".x", "a" * 300, "é.mtl", "x\ty", "a\u0000b", None]), kind, data)
    elif how == 4 and name in ("animation", "options"):
        try:
            parts[at] = (name, file_name, kind, json.dumps(mutated(rng, json.loads(data))).encode("utf-8", "surrogatepass"))
        except ValueError:
            pass
    elif how == 5:
        parts[at] = (name, file_name, kind, broken_text(rng, data.decode("utf-8", "replace")))
    else:
        parts[at] = (name, file_name, rng.choice(["", "x", "image/png", "multipart/mixed; boundary=q"]), data)
    return parts


def broken_multipart(rng, body):
    at = rng.randrange(len(body) + 1)
    return rng.choice([
        lambda: body[:at], lambda: body[at:], lambda: body.replace(b"\r\n", b"\n"), lambda: body.replace(b"form-data", b"file", 1), lambda: b"",
        lambda: b"preamble\r\n" + body, lambda: body + b"epilogue", lambda: body.replace(b"name=", b"nome=", 1),
        lambda: body.replace(b"Content-Disposition", b"X" * 9000, 1), lambda: body[:at] + bytes([rng.randrange(256)] * 3) + body[at:],
        lambda: body.replace(b"\r\n\r\n", b"\r\n", 1), lambda: body[:-4] + b"\r\n"])()
