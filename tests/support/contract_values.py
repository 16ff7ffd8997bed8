"""Values made from JSON Schemas by a seeded random.Random: valid ones, and ones with something wrong."""
import json
import re

ODD_TEXTS = ["", " ", "0", "-1", "null", "true", "..", "../..", "%00", "a/b", "\u0000", "\u202e", "é", "日本語", "'", '"', "\\", "<b>",
             "${x}", "%s%n", "1e999", "NaN", "9" * 40, "x" * 300, "😀", "\u007f", "a\tb", "-0", "0x10", "1.5", "٣"]
ODD_VALUES = [None, True, False, 0, -1, 1, 1.5, -0.0, 1e308, -1e308, 2**31, 2**53 + 1, 2**63, -(2**63), 2**64, 10**40, "", [], {}, [[]],
              [None], {"": None}, {"x": {"x": {"x": 1}}}]
# Texts to try where a schema has a pattern.
SAMPLES = ["a", "project", "project:garage", "garage", "front", "7.png", "0.jpg", "0.exr", "ab" * 16, "ab" * 32, "x-1", "1", "0a",
           "5f2b7c9e-0d1a-4c3b-9b57-0f6f4f0c9a11"]


class Values:
    """`resolve`: follows $ref."""

    def __init__(self, resolve):
        self.resolve = resolve

    def valid(self, rng, schema, depth=0):
        schema = self.resolve(schema)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return rng.choice(schema["enum"])
        if schema.get("examples") and rng.random() < 0.2:
            return rng.choice(schema["examples"])
        for word in ("anyOf", "oneOf"):
            if word in schema and "properties" not in schema:
                return self.valid(rng, rng.choice(schema[word]), depth)
        kind = schema.get("type", "object")
        kind = rng.choice(kind) if isinstance(kind, list) else kind
        return getattr(self, kind)(rng, schema, depth)

    def null(self, rng, schema, depth):
        return None

    def boolean(self, rng, schema, depth):
        return rng.random() < 0.5

    def integer(self, rng, schema, depth):
        low, high = schema.get("minimum", -10), schema.get("maximum", 1000)
        return rng.choice([low, high, rng.randint(low, high), min(high, low + rng.randint(0, 3))])

    def number(self, rng, schema, depth):
        low = schema.get("minimum", schema.get("exclusiveMinimum", -10.0))
        high = schema.get("maximum", schema.get("exclusiveMaximum", 1000.0))
        value = low + (high - low) * rng.uniform(0.01, 0.99)
        return value if "exclusiveMinimum" in schema else rng.choice([low, value])

    def string(self, rng, schema, depth):
        if schema.get("format") == "date-time":
            return f"20{rng.randint(27, 99)}-0{rng.randint(1, 9)}-1{rng.randint(0, 9)}T08:15:{rng.randint(10, 59)}Z"
        if "pattern" in schema:
            fitting = [text for text in SAMPLES if re.search(schema["pattern"], text) and
                       schema.get("minLength", 0) <= len(text) <= schema.get("maxLength", 1 << 20)]
            return rng.choice(fitting or schema.get("examples") or ["a"])
        length = min(schema.get("maxLength", 20), max(schema.get("minLength", 0), rng.choice([0, 1, 8, 20])))
        return "".join(rng.choice("abcxyz -_.é0189") for _ in range(length))

    def array(self, rng, schema, depth):
        low = schema.get("minItems", 0)
        count = min(schema.get("maxItems", 4), low + (rng.randint(0, 3) if depth < 4 else 0))
        items = [self.valid(rng, schema.get("items", {"type": "integer"}), depth + 1) for _ in range(count)]
        if schema.get("uniqueItems"):
            items = [json.loads(text) for text in dict.fromkeys(map(json.dumps, items))]
        return items

    def object(self, rng, schema, depth):
        result = {}
        for name, inner in schema.get("properties", {}).items():
            if name in schema.get("required", ()) or (depth < 4 and rng.random() < 0.4):
                result[name] = self.valid(rng, inner, depth + 1)
        more = schema.get("additionalProperties")
        if isinstance(more, dict) and depth < 4:
            for _ in range(rng.randint(0, 2)):
                result[rng.choice(["project", "a", "b.c", "x-1"])] = self.valid(rng, more, depth + 1)
        return result


def places(value, found=None):
    """(container, key) of everything inside."""
    found = [] if found is None else found
    if isinstance(value, (dict, list)):
        for key, item in list(value.items() if isinstance(value, dict) else enumerate(value)):
            found.append((value, key))
            places(item, found)
    return found


def odd_value(rng):
    return rng.choice(ODD_TEXTS) if rng.random() < 0.4 else json.loads(json.dumps(rng.choice(ODD_VALUES)))


def mutated(rng, value):
    """A copy with one place of another type, missing, added, doubled or far off."""
    value = json.loads(json.dumps(value))
    found = places(value)
    if not found or rng.random() < 0.05:
        return odd_value(rng)
    container, key = rng.choice(found)
    how = rng.randrange(5)
    if how == 0:
        del container[key]
    elif how == 1 and isinstance(container, dict):
        container[rng.choice(["x", "", "__proto__", str(key) + "s", "é" * 40, *ODD_TEXTS[:6]])] = odd_value(rng)
    elif how == 2 and isinstance(container, list):
        container += [container[key]] * rng.choice([1, 3, 500])
    elif how == 3 and isinstance(container[key], (int, float)) and not isinstance(container[key], bool):
        container[key] = rng.choice([-1, -1e300, 1e300, 10**30, 0, 0.5, -container[key], container[key] * 1e6])
    else:
        container[key] = odd_value(rng)
    return value


def broken_text(rng, text):
    """JSON bytes that are hardly JSON any more."""
    data = text.encode("utf-8", "surrogatepass")
    at = rng.randrange(len(data) + 1)
    return rng.choice([
        lambda: data[:at], lambda: data[:at] + bytes(rng.randrange(256) for _ in range(4)) + data[at:], lambda: b"",
        lambda: b"[" * 200 + b"]" * 200, lambda: b"[" * 20_000, lambda: b'{"a":' * 100 + b"1" + b"}" * 100, lambda: b"\xef\xbb\xbf" + data,
        lambda: text.encode("utf-16", "replace"), lambda: data + b" x", lambda: data + data, lambda: b"NaN", lambda: b"1e99999",
        lambda: data.replace(b":", b":NaN,", 1), lambda: data.replace(b"{", b'{"a":1,"a":2,', 1), lambda: b'"\\ud800"',
        lambda: data.replace(b'"', b"'"), lambda: b"\x00" * 64, lambda: data + b" " * 9000, lambda: data + b" " * 300_000,
        lambda: b"[" + b"1," * 5000 + b"1]", lambda: b'{"x":"' + b"y" * 20_000 + b'"}'])()
