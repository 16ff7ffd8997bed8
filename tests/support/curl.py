"""HTTP through curl, as a client would."""
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from exchange_check import check


@dataclass
class Answer:
    status: int
    headers: dict  # names in lower case
    body: bytes

    def json(self):
        return json.loads(self.body)


def parse_headers(text):
    """Those of the last response: a 100 Continue may stand before it."""
    blocks = [block for block in text.replace("\r\n", "\n").split("\n\n") if block.strip()]
    lines = blocks[-1].splitlines()[1:] if blocks else []
    return {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}


def curl(url, *arguments, timeout_s=60, checked=True):
    """-> Answer. Raises CalledProcessError where there is no HTTP answer at all, AssertionError where it is not one that
    api/openapi.yaml has and that is `checked`."""
    with tempfile.TemporaryDirectory() as folder:
        body, headers = Path(folder, "body"), Path(folder, "headers")
        run = subprocess.run(["curl", "-sS", "--max-time", str(timeout_s), "-o", str(body), "-D", str(headers),
                              "-w", "%{http_code}", *arguments, url], capture_output=True, text=True)
        if run.returncode != 0:
            raise subprocess.CalledProcessError(run.returncode, run.args, run.stdout, run.stderr)
        # For HEAD (-I) curl writes the headers where the body would go.
        has_body = body.exists() and "-I" not in arguments
        answer = Answer(int(run.stdout), parse_headers(headers.read_text(errors="replace")),
                        body.read_bytes() if has_body else b"")
        if checked:
            check(url, arguments, answer)
        return answer
