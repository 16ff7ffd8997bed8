"""What curl sends and gets in the tests, held against api/openapi.yaml; nothing where python3-jsonschema is missing."""
from urllib.parse import urlsplit

try:
    from contract import Contract, Exchange
except ImportError:
    Contract = None

BODY_OPTIONS = ("-d", "--data", "--data-binary")
contract = None


def method_of(arguments):
    """As curl takes it from its options."""
    if "-X" in arguments:
        return arguments[arguments.index("-X") + 1]
    if "-I" in arguments:
        return "HEAD"
    if "-T" in arguments:
        return "PUT"
    return "POST" if {"-F", *BODY_OPTIONS}.intersection(arguments) else "GET"


def body_of(arguments):
    """What the options themselves hold of it; None where it comes from a file."""
    for option, value in zip(arguments, arguments[1:]):
        if option in BODY_OPTIONS and not value.startswith("@"):
            return value.encode("utf-8", "surrogateescape")
    return None


def check(url, arguments, answer):
    """Raises AssertionError where the document does not allow the answer. `answer`: curl.Answer"""
    global contract
    if Contract is None:
        return
    contract = contract or Contract()
    parts = urlsplit(url)
    path = parts.path + (f"?{parts.query}" if parts.query else "")
    is_stream = answer.headers.get("content-type", "").startswith("text/event-stream")
    problems = contract.problems(Exchange(method_of(arguments), path, answer.status, answer.headers, answer.body, body_of(arguments),
                                          is_whole=not is_stream))
    if problems:
        raise AssertionError(f"{method_of(arguments)} {path} is not answered as api/openapi.yaml says:\n  " + "\n  ".join(problems))
