#!/usr/bin/env python3
"""docs_page.py OPENAPI_YAML OUTPUT_CPP

The OpenAPI document as one page of HTML for people, as a C++ source. No script and nothing from elsewhere: the page's
Content-Security-Policy allows its own style, by hash, and nothing more.
"""
import base64
import hashlib
import html
import re
import sys
from pathlib import Path

import yaml

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222; }
h2 { border-bottom: 1px solid #bbb; margin-top: 2.5em; }
h3 { margin: 1.8em 0 0.3em; font-size: 1em; }
code, pre { font: 13px/1.45 ui-monospace, monospace; background: #f3f3f3; }
pre { padding: 0.6em; overflow-x: auto; }
b.m { display: inline-block; min-width: 4.5em; color: #0a5; }
table { border-collapse: collapse; margin: 0.4em 0; }
td { padding: 0.1em 1.2em 0.1em 0; vertical-align: top; }
nav a { display: block; text-decoration: none; color: #246; }
@media (prefers-color-scheme: dark) {
  body { background: #181818; color: #ddd; } code, pre { background: #262626; } nav a { color: #9bd; } b.m { color: #5d9; }
}
"""
METHODS = ("get", "post", "put", "patch", "delete")


def text(value):
    """Escaped; `code` in backquotes as code."""
    escaped = html.escape(" ".join(str(value or "").split()))
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escaped)


def resolved(document, item):
    """A parameter or response, itself or behind its $ref into the document."""
    while isinstance(item, dict) and str(item.get("$ref", "")).startswith("#/"):
        target = document
        for step in item["$ref"][2:].split("/"):
            target = target[step]
        item = target
    return item


def kind_of(schema):
    if "$ref" in schema:
        return schema["$ref"].rsplit("/", 1)[-1].split(".")[0]
    kind = schema.get("type", "")
    kind = " or ".join(kind) if isinstance(kind, list) else kind
    if "enum" in schema:
        kind = " | ".join(str(value) for value in schema["enum"])
    limits = [f"from {schema['minimum']}" if "minimum" in schema else "", f"to {schema['maximum']}" if "maximum" in schema else "",
              f"default {schema['default']}" if "default" in schema else ""]
    return ", ".join(part for part in [kind, *limits] if part)


def rows(pairs):
    return "<table>" + "".join(f"<tr><td>{first}</td><td>{second}</td></tr>" for first, second in pairs) + "</table>"


def curl(method, path, operation):
    words = ["curl"] + ([f"-X {method.upper()}"] if method != "get" else [])
    kinds = (operation.get("requestBody") or {}).get("content", {})
    if "multipart/form-data" in kinds:
        words = ["curl", "-F scene=@scene.obj", "-F materials=@scene.mtl", "-F animation=@animation.json"]
    elif "application/json" in kinds:
        words += ["-H 'Content-Type: application/json'", "-d @body.json"]
    return f"<pre>{html.escape(' '.join(words))} $KEYLUME{html.escape(path)}</pre>"


def operation_html(document, path, method, operation, shared):
    parts = [f'<h3 id="{operation["operationId"]}"><b class="m">{method.upper()}</b> <code>{html.escape(path)}</code></h3>',
             f"<p>{text(operation.get('summary'))} {text(operation.get('description'))}</p>"]
    parameters = [resolved(document, item) for item in shared + operation.get("parameters", [])]
    if parameters:
        parts.append(rows((f"<code>{item['name']}</code> in {item['in']}",
                           f"{text(item.get('description'))} {text(kind_of(item.get('schema', {})))}") for item in parameters))
    parts.append(curl(method, path, operation))
    answers = ((str(status), resolved(document, answer)) for status, answer in operation["responses"].items())
    parts.append(rows((f"<b>{status}</b>", text(answer.get("description"))) for status, answer in answers))
    return "\n".join(parts)


def page(document):
    info = document["info"]
    parts = [f"<h1>{text(info['title'])} {text(info['version'])}</h1>", f"<p>{text(info['summary'])}</p>",
             f"<p>{text(info['description'])}</p>",
             '<p>For machines: <a href="/openapi.json">/openapi.json</a>. In the examples <code>$KEYLUME</code> is where the '
             "service is; where it asks for a token add <code>-H \"Authorization: Bearer $TOKEN\"</code>.</p>"]
    operations = [(path, method, item[method], item.get("parameters", []))
                  for path, item in document["paths"].items() for method in METHODS if method in item]
    parts.append("<nav>" + "".join(f'<a href="#{operation["operationId"]}">{method.upper()} {html.escape(path)}</a>'
                                   for path, method, operation, _ in operations) + "</nav>")
    common = document.get("x-answers-of-every-operation", {})
    parts.append("<h2>Answers that every request may get</h2>")
    parts.append(rows((f"<b>{status}</b>", text(resolved(document, answer).get("description")))
                      for status, answer in common.items()))
    for tag in document["tags"]:
        parts.append(f"<h2>{text(tag['name'])}</h2><p>{text(tag.get('description'))}</p>")
        parts += [operation_html(document, path, method, operation, shared)
                  for path, method, operation, shared in operations if tag["name"] in operation.get("tags", [])]
    return ('<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Keylume</title>'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<style>{STYLE}</style></head><body>" + "\n".join(parts) + "</body></html>\n")


def main():
    source, output = Path(sys.argv[1]), Path(sys.argv[2])
    content = page(yaml.safe_load(source.read_text()))
    content = content.encode("ascii", "xmlcharrefreplace").decode()
    digest = base64.b64encode(hashlib.sha256(STYLE.encode()).digest()).decode()
    # In pieces: compilers limit the length of one literal.
    pieces = "\n".join(f'    R"html({content[at:at + 8000]})html"' for at in range(0, len(content), 8000))
    output.write_text("// Generated from api/openapi.yaml.\n"
                      '#include "server/http/routes.h"\n\nnamespace server {\n\n'
                      f"std::string_view docs_page() {{\n  return\n{pieces};\n}}\n\n"
                      f'std::string_view docs_style_hash() {{\n  return "sha256-{digest}";\n}}\n\n}}  // namespace server\n')


if __name__ == "__main__":
    main()
