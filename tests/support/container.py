"""The service's programs as containers of the image KEYLUME_CONTAINER, in the place of those that were built here.

Command lines are translated: folders of tests are mounted where they lie, listeners are published on 127.0.0.1, and the
container is confined as docker/compose.yaml confines it. Data folders stay files of this machine, to be looked at."""
import os
import signal
import subprocess
import tempfile
import uuid
from pathlib import Path

IMAGE = os.environ.get("KEYLUME_CONTAINER", "")
USER = 10001
CONFINED = ["--read-only", "--cap-drop=ALL", "--security-opt=no-new-privileges", "--pids-limit=512", "--tmpfs=/tmp:size=64m"]
LABEL = "keylume.test"
SERVICE_PORT, OPS_PORT = 8080, 8081
# The image's own settings, which would stand in for words that a command line does not have.
NOT_SET = [f"--env=KEYLUME_{name}=" for name in ("DATA", "LISTEN", "OPS_LISTEN", "TOKEN_FILE")]


def docker(*words, timeout_s=60, checked=True):
    """-> what it printed, without the end of the last line; or, not `checked`, the finished run"""
    run = subprocess.run(["docker", *map(str, words)], capture_output=True, text=True, timeout=timeout_s,
                         stdin=subprocess.DEVNULL)
    if not checked:
        return run
    if run.returncode != 0:
        raise AssertionError(f"docker {' '.join(map(str, words))}: {run.returncode}\n{run.stdout}{run.stderr}")
    return run.stdout.rstrip("\n")


def folder_of_test(path):
    """The temporary folder of a test that `path` lies in, or None."""
    top = Path(tempfile.gettempdir()).resolve()
    path = Path(os.path.abspath(path))
    return top / path.relative_to(top).parts[0] if top in path.parents else None


def give_to_the_service(folder):
    """Tests make folders as root, the service in the container is another user."""
    if os.getuid() != 0:
        return
    for place, _, names in os.walk(folder):
        for each in (place, *(os.path.join(place, name) for name in names)):
            try:
                if os.lstat(each).st_uid == 0:
                    os.lchown(each, USER, USER)
            except FileNotFoundError:
                pass  # the service itself removed it meanwhile


def mounts_of(words):
    """-> options of `docker run` for the paths among the words of a command line"""
    folders, single = set(), set()
    for word in words:
        path = word.partition("=")[2] if word.startswith("--") else word
        if not path.startswith("/"):
            continue
        folder = folder_of_test(path)
        if folder:
            folders.add(folder)
        elif Path(path).exists():
            single.add(path)
    for folder in folders:
        folder.mkdir(exist_ok=True)
        give_to_the_service(folder)
    return [f"--volume={folder}:{folder}" for folder in sorted(folders)] + [f"--volume={path}:{path}:ro" for path in sorted(single)]


def value_of(words, name):
    return words[words.index(name) + 1] if name in words else None


def without(words, name, value):
    """`words` but for an option with that value: the image has its own."""
    if value_of(words, name) != value:
        return words
    at = words.index(name)
    return words[:at] + words[at + 2:]


def published(words, name, port):
    """-> (words with the listener moved to `port` of the container, options that publish it where it was)"""
    address = value_of(words, name)
    if not address or address == "off":
        return words, []
    at = words.index(name)
    outside = address.rpartition(":")[2]
    return [*words[:at + 1], f"0.0.0.0:{port}", *words[at + 2:]], [f"--publish=127.0.0.1:{outside}:{port}"]


def server_words(words):
    """-> (options of `docker run`, words for the server) of a command line of keylume-server, without its first word"""
    words = without(list(words), "--worker", os.environ["KEYLUME_WORKER"])
    words = without(words, "--dashboard", os.environ.get("KEYLUME_DASHBOARD"))
    serves = bool(words) and words[0].startswith("--") and "--data" in words
    if not serves:
        return ["--network=none"], words
    was_public = any(not (value_of(words, name) or "127.").startswith(("127.", "off")) for name in ("--listen", "--ops-listen"))
    words, options = published(words, "--listen", SERVICE_PORT)
    words, ops_options = published(words, "--ops-listen", OPS_PORT)
    if not was_public:  # on this machine nobody else reaches the port that is published
        words += ["--insecure-public"] + ([] if "--rate-limit" in words else ["--rate-limit", "0"])
    return options + ops_options, words


def command_line(program, words, name=None):
    """-> the words of `docker run` for `keylume-server` or `keylume` with `words`"""
    words = [str(word) for word in words]
    options = ["--network=none"]
    if program == "keylume-server":
        options, words = server_words(words)
    user = f"{USER}:{USER}" if os.getuid() == 0 else f"{os.getuid()}:{os.getgid()}"
    return ["docker", "run", "--rm", f"--label={LABEL}", *([f"--name={name}"] if name else []), f"--user={user}", *CONFINED,
            *NOT_SET, *mounts_of(words), *options, f"--entrypoint={program}", IMAGE, *words]


class ContainerProcess:
    """A server in a container, with what tests use of subprocess.Popen."""

    def __init__(self, words, **streams):
        self.name = f"keylume-test-{uuid.uuid4().hex[:12]}"
        self.run = subprocess.Popen(command_line("keylume-server", words[1:], self.name), **streams)

    @property
    def pid(self):
        """Of the process in the container, as this machine counts."""
        return int(docker("inspect", "--format={{.State.Pid}}", self.name))

    @property
    def returncode(self):
        return self.run.returncode

    def poll(self):
        return self.run.poll()

    def wait(self, timeout=None):
        return self.run.wait(timeout)

    def send_signal(self, number):
        docker("kill", f"--signal={signal.Signals(number).name}", self.name, checked=False)

    def terminate(self):
        self.send_signal(signal.SIGTERM)

    def kill(self):
        self.send_signal(signal.SIGKILL)


def popen(words, **streams):
    return ContainerProcess(words, **streams) if IMAGE else subprocess.Popen(words, **streams)
