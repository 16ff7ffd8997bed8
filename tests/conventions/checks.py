"""The project's conventions as functions: each takes the checkout (and the build folder where it needs one) and
returns a list of sentences, one for each place that breaks the convention."""
import json
import os
import re
import subprocess
from pathlib import Path

SKIPPED_FOLDERS = {"build", "data", ".git", "node_modules", "generated", "__pycache__"}
SOURCE_FOLDERS = ("api", "engine", "server", "tests")
LINES_MAX = 400
CLANG_FORMAT_MAJOR = 14
DASHBOARD_COLUMNS_MAX = 200
PUBLIC_TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: :.*)? \{", re.MULTILINE)
UNITY_FILE = re.compile(r"/Unity/unity_\d+_\w+\.\w+$")
OWN_NAME = re.compile(r"(?:template <.*> )?(?!return|using|struct|enum|class|static_assert)[A-Za-z_][\w:<>,\s*&\[\]]*?[\s*&](\w+)\("
                      r"|(?:struct|class|enum class) (\w+)|(?:constexpr|const) .*?(k[A-Z]\w+)")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def files_of(root, *suffixes):
    """Every file of the checkout with one of the suffixes (all of them if none is given), sorted."""
    found = []
    for folder, inner, names in os.walk(root):
        inner[:] = [name for name in inner if name not in SKIPPED_FOLDERS]  # not looked into: large, and under change
        found += [Path(folder, name) for name in names if not suffixes or Path(name).suffix in suffixes]
    return sorted(path for path in found if path.is_file())


def sources_of(root, *suffixes):
    return [path for path in files_of(root, *suffixes) if path.relative_to(root).parts[0] in SOURCE_FOLDERS]


def lines_with_content(path):
    """(number, text) of the lines that are neither empty nor a comment."""
    for number, line in enumerate(Path(path).read_text().splitlines(), 1):
        if line.strip() and not line.startswith("#"):
            yield number, line.strip()


class IncludeRules:
    """tests/conventions/includes.txt, read."""

    def __init__(self, path):
        self.allowed = {}  # folder -> set of folders or headers
        self.only = []     # (prefix of a third-party header, folders)
        for number, line in lines_with_content(path):
            match = re.fullmatch(r"(order|allow|only) ([^:]+): *(.*)", line)
            if not match:
                raise ValueError(f"{path}:{number}: not a rule: {line}")
            kind, subject, rest = match[1], match[2].strip(), match[3].split()
            if kind == "order":
                for position, name in enumerate(rest):
                    before = {f"{subject}/{other}" for other in rest[:position]}
                    self.allowed.setdefault(f"{subject}/{name}", set()).update(before)
            elif kind == "allow":
                self.allowed.setdefault(subject, set()).update(rest)
            else:
                self.only += [(prefix, set(rest)) for prefix in subject.split()]

    def targets_of(self, folder):
        """What `folder` may include: its own rules, those of the folders around it; `FOLDER/.` is FOLDER alone."""
        targets = {folder} | self.allowed.get(f"{folder}/.", set())
        while folder:
            targets |= self.allowed.get(folder, set())
            folder = folder.rpartition("/")[0]
        return targets


def own_include_problem(rules, folder, header):
    if rules.targets_of(folder).intersection((header, header.rpartition("/")[0])):
        return None
    return f"{folder} may not include {header} (tests/conventions/includes.txt)"


def third_party_problem(rules, folder, header):
    for prefix, folders in rules.only:
        if header.startswith(prefix) and folder not in folders:
            return f"only {', '.join(sorted(folders))} may include <{header}>"
    return None


def includes(root, rules_path):
    """Includes between folders follow the table; ours are written from the root, in double quotes."""
    rules, problems = IncludeRules(rules_path), []
    for path in sources_of(root, ".h", ".cpp"):
        relative = path.relative_to(root)
        folder, top = relative.parent.as_posix(), relative.parts[0]
        for quote, header in INCLUDE.findall(path.read_text(errors="replace")):
            is_ours = header.split("/")[0] in SOURCE_FOLDERS
            problem = None
            if is_ours and top != "tests":
                problem = own_include_problem(rules, folder, header)
            elif not is_ours and quote == '"':
                problem = f'"{header}" is not written from the root of the checkout'
            elif not is_ours and top != "tests":
                problem = third_party_problem(rules, folder, header)
            if problem:
                problems.append(f"{relative}: {problem}")
    return problems


def sources_of_targets(build):
    """Target -> its sources, where the build compiles several of them as one as well."""
    targets = {}
    for entry in json.loads((Path(build) / "compile_commands.json").read_text()):
        file = Path(entry["directory"], entry["file"]).resolve()
        together = re.findall(r'^#include "(.+)"', file.read_text(), re.MULTILINE) if UNITY_FILE.search(str(file)) else []
        target = re.search(r"-o (\S*CMakeFiles/[^/\s]+)\.dir/", entry["command"])
        targets.setdefault(target[1] if target else "", set()).update(map(Path, together or [file]))
    return targets


def sources_are_built(root, build):
    """Every .cpp is compiled by some target; fuzz targets are, in a build of their own, where their list names them."""
    fuzz = Path(root) / "tests/fuzz"
    fuzzers = (fuzz / "CMakeLists.txt").read_text() if fuzz.is_dir() else ""
    compiled = {path.resolve() for sources in sources_of_targets(build).values() for path in sources}
    return [f"{path.relative_to(root)}: no target compiles it" for path in sources_of(root, ".cpp")
            if path.resolve() not in compiled and not (path.parent == fuzz and f"add_fuzzer({path.stem}" in fuzzers)]


def names_of_its_own(text):
    """What a source declares in unnamed namespaces, at the start of a line: functions, types and constants."""
    inside = False
    for line in text.splitlines():
        if line in ("namespace {", "}  // namespace"):
            inside = line == "namespace {"
        elif inside and (name := OWN_NAME.match(line)):
            yield name[1] or name[2] or name[3]


def own_names(root, build):
    """The release build compiles the sources of a target together: an unnamed namespace is then one for all of them, and
    a function might be called in place of another file's. No two sources of a target declare the same name there, and
    none that of a type in a header of ours."""
    headers = sources_of(root, ".h")
    types = {name: path for path in headers for name in PUBLIC_TYPE.findall(path.read_text())}
    problems = []
    for target, sources in sorted(sources_of_targets(build).items()):
        known = {}
        ours = [path for path in sources if path.is_relative_to(root) and path.relative_to(root).parts[0] != "tests"]
        for path in sorted(ours):
            for name in sorted(set(names_of_its_own(path.read_text()))):
                other = known.setdefault(name, types.get(name, path))
                if other != path and path.relative_to(root).parts[0] == other.relative_to(root).parts[0]:
                    problems.append(f"{path.relative_to(root)}: {name} is a name of {other.relative_to(root)} too")
    return problems


LABELS = {"unit", "accuracy", "integration", "faults", "conventions", "bench", "browser", "fuzz", "peers", "container"}


def registered_tests(build):
    output = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, check=True, capture_output=True, text=True)
    return json.loads(output.stdout)["tests"]


def tests_are_registered(root, tests):
    """Every test has one label and a time limit, and every test file is run that is no C++. `tests`: as ctest lists them."""
    problems, words = [], set()
    for test in tests:
        properties = {item["name"]: item["value"] for item in test.get("properties", [])}
        words.update(Path(word).name for word in test.get("command", []))
        if len(LABELS.intersection(properties.get("LABELS", []))) != 1:
            problems.append(f"test {test['name']}: needs exactly one label of {', '.join(sorted(LABELS))}")
        if not properties.get("TIMEOUT"):
            problems.append(f"test {test['name']}: has no time limit")
    for path in sources_of(root, ".py", ".mjs"):
        if path.name.endswith(("_test.py", "_test.mjs")) and path.name not in words:
            problems.append(f"{path.relative_to(root)}: ctest does not run it")
    return problems


def file_lengths(root, exceptions_path):
    """No source has more than 400 lines, but for those listed."""
    exceptions = {line.split()[0] for _, line in lines_with_content(exceptions_path)}
    problems = []
    for path in files_of(root, ".h", ".cpp", ".py", ".sh", ".cmake", ".txt", ".sql", ".ts", ".mjs", ".css", ""):
        relative = path.relative_to(root).as_posix()
        count = len(path.read_text(errors="replace").splitlines())
        if count > LINES_MAX and relative not in exceptions:
            problems.append(f"{relative}: {count} lines, at most {LINES_MAX}")
    return problems


def clang_format_version():
    """Its major version, or None where there is none."""
    try:
        output = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    match = re.search(r"version (\d+)", output)
    return int(match[1]) if match else None


def layout(root):
    """The sources are as clang-format writes them."""
    problems = []
    for path in sources_of(root, ".h", ".cpp"):
        run = subprocess.run(["clang-format", "--dry-run", "--Werror", str(path)], capture_output=True, text=True)
        if run.returncode != 0:
            first = run.stderr.splitlines()[0] if run.stderr else ""
            problems.append(f"{path.relative_to(root)}: clang-format -i would change it {first.partition(': ')[0]}")
    return problems


def dashboard_layout(root):
    """TypeScript, scripts and styles: two spaces, no tabs, nothing at the ends of lines, none too long to read."""
    problems = []
    for path in sources_of(root, ".ts", ".mjs", ".css"):
        text = path.read_text()
        for number, line in enumerate(text.splitlines(), 1):
            indent = len(line) - len(line.lstrip(" "))
            odd = indent % 2 == 1 and not line.lstrip().startswith("*")  # the second line of a /** comment
            if "\t" in line or line != line.rstrip() or odd or len(line) > DASHBOARD_COLUMNS_MAX:
                problems.append(f"{path.relative_to(root)}:{number}: a tab, an odd indent, space at the end, or too long")
        if text and not text.endswith("\n"):
            problems.append(f"{path.relative_to(root)}: no newline at the end")
    return problems


def dashboard_imports(root):
    """Every .ts, but for workers and the start, is imported by another, relative to itself; styles likewise."""
    folder = Path(root) / "server/dashboard/src"
    imported = {folder / "main.ts"}
    for path in files_of(root, ".ts"):
        for target in re.findall(r"""(?:from|import)\s*\(?\s*["'](\.[^"']+)["']""", path.read_text()):
            found = (path.parent / target).resolve()
            imported.add(found if found.suffix == ".css" else found.with_name(found.name + ".ts"))
    return [f"{path.relative_to(root)}: nothing imports it" for path in files_of(root, ".ts", ".css")
            if folder in path.parents and path not in imported and not path.name.endswith("_worker.ts")]


ADDRESS = re.compile(r"\b(?:https?|ftp|git)://([^\s\"'<>)$`{\]]*)")


def word_problems(text, words, allowed_addresses):
    """What one text holds that it should not. `words`: (pattern, reason)."""
    for number, line in enumerate(text.splitlines(), 1):
        for pattern, reason in words:
            if re.search(pattern, line):
                yield f"{number}: {line.strip()[:80]!r}: {reason}"
        for address in ADDRESS.findall(line):
            if address and not any(re.match(re.escape(allowed) + r"(\W|$)", address) for allowed in allowed_addresses):
                yield f"{number}: the address {address} is not in allowed_addresses.txt"


def commit_messages(root):
    """All of them in one text, or "" where this is no git checkout or git is missing."""
    try:
        run = subprocess.run(["git", "-C", str(root), "log", "--format=%B"], capture_output=True, text=True)
    except OSError:
        return ""
    return run.stdout if run.returncode == 0 else ""


def words(root, words_path, addresses_path, messages=""):
    """No file and no commit message names somebody's machine, a foreign address, or unfinished work."""
    patterns = [tuple(re.split(r" {2,}", line, maxsplit=1)) for _, line in lines_with_content(words_path)]
    addresses = {line for _, line in lines_with_content(addresses_path)}
    problems = [f"commit message: {found}" for found in word_problems(messages, patterns, addresses)]
    for path in files_of(root):
        try:
            text = path.read_text()
        except UnicodeDecodeError:
            continue  # a picture
        problems += [f"{path.relative_to(root)}:{found}" for found in word_problems(text, patterns, addresses)]
    return problems


def code_blocks(markdown):
    """The lines of its shell code blocks, continuation lines joined."""
    for block in re.findall(r"^```(?:sh|bash|console)\n(.*?)^```", markdown, re.MULTILINE | re.DOTALL):
        yield from block.replace("\\\n", " ").splitlines()


COMMANDS = {"(", ")", "cat", "cmake", "cp", "ctest", "curl", "do", "docker", "done", "echo", "mkdir", "python3",
            "sleep", "until"}


def first_word(line):
    """The command a line of shell begins with; of `name=$(command ...)` the one inside."""
    return re.sub(r"^\w+=\$\(", "", line.strip()).split(" ")[0]


def documents(root):
    """Commands and paths named in README and CONTRIBUTING exist; the table of exit codes is that of the code."""
    root, problems = Path(root), []
    for name in ("README.md", "CONTRIBUTING.md"):
        text = (root / name).read_text()
        for line in code_blocks(text):
            first = first_word(line)
            is_known = first in COMMANDS or first.startswith(("#", "build/")) or (root / first).is_file()
            if first and not is_known:
                problems.append(f"{name}: no such command: {line.strip()}")
        for path in re.findall(r"`((?:api|docker|engine|server|tests)/[\w./-]*)`", text):
            if not (root / path).exists():
                problems.append(f"{name}: no such path: {path}")
    in_code = set(re.findall(r"^  \w+ = (\d+),", (root / "api/exit_code.h").read_text(), re.MULTILINE))
    section = (root / "README.md").read_text().partition("exit code")[2].partition("\n## ")[0]
    in_readme = set(re.findall(r"^\| (\d+) \|", section, re.MULTILINE))
    if in_code != in_readme:
        problems.append(f"README.md: exit codes {sorted(in_readme)}, api/exit_code.h has {sorted(in_code)}")
    return problems
