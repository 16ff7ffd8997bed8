"""Where JSON Schema and OpenAPI documents refer to other places."""


def references(node):
    """Every `$ref` in it, as it is written."""
    if isinstance(node, dict):
        if isinstance(node.get("$ref"), str):
            yield node["$ref"]
        for value in node.values():
            yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)
