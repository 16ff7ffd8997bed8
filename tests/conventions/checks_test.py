#!/usr/bin/env python3
"""Each check finds what is wrong in a small tree that breaks every convention, and nothing in one that keeps them."""
import json
import shutil
import tempfile
import unittest
from pathlib import Path

import checks

HERE = Path(__file__).resolve().parent

GOOD = {
    "api/exit_code.h": "enum class ExitCode : int {\n  ok = 0,\n  internal = 1,\n};\n",
    "engine/scene/scene.h": '#include "api/exit_code.h"\n',
    "engine/visibility/rays.cpp": '#include <embree3/rtcore.h>\n\n#include "engine/scene/scene.h"\n',
    "server/run": "#!/bin/bash\n",
    "README.md": "See `engine/scene/scene.h`.\n```sh\nserver/run\n```\nIts exit code:\n| 0 | ok |\n| 1 | bug |\n",
    "CONTRIBUTING.md": "```sh\nctest\n```\n",
    "tests/integration/job_test.py": "",
}


class OnATree(unittest.TestCase):
    def setUp(self):
        self.root = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)
        for path, text in GOOD.items():
            self.write(path, text)

    def write(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def expect_one(self, problems, *parts):
        self.assertEqual(len(problems), 1, problems)
        for part in parts:
            self.assertIn(part, problems[0])

    def includes(self):
        return checks.includes(self.root, HERE / "includes.txt")

    def words(self, messages=""):
        return checks.words(self.root, HERE / "words.txt", HERE / "allowed_addresses.txt", messages)

    def test_a_good_tree_passes(self):
        self.assertEqual(self.includes(), [])
        self.assertEqual(self.words("api: say what went wrong"), [])
        self.assertEqual(checks.documents(self.root), [])
        self.assertEqual(checks.file_lengths(self.root, HERE / "long_files.txt"), [])

    def test_a_stage_that_includes_a_later_one(self):
        self.write("engine/scene/bad.cpp", '#include "engine/visibility/rays.h"\n')
        self.expect_one(self.includes(), "engine/scene/bad.cpp", "engine/visibility/rays.h")

    def test_the_server_including_the_engine_and_the_reverse(self):
        self.write("server/jobs/bad.cpp", '#include "engine/pipeline/run_pipeline.h"\n')
        self.expect_one(self.includes(), "server/jobs/bad.cpp")
        self.write("server/jobs/bad.cpp", "")
        self.write("engine/worker/bad.cpp", '#include "server/jobs/job.h"\n')
        self.expect_one(self.includes(), "engine/worker/bad.cpp")

    def test_the_contract_including_anything_of_ours(self):
        self.write("api/bad.h", '#include "engine/base/vec3.h"\n')
        self.expect_one(self.includes(), "api/bad.h")

    def test_a_header_that_one_folder_may_see_only_through_its_own_line(self):
        self.write("engine/direct/good.cpp", '#include "engine/lighting/radiosity.h"\n')
        self.assertEqual(self.includes(), [])
        self.write("engine/direct/bad.cpp", '#include "engine/lighting/solve_lighting.h"\n')
        self.expect_one(self.includes(), "engine/direct/bad.cpp")

    def test_third_party_headers_outside_their_folder(self):
        for header in ("nlohmann/json.hpp", "embree3/rtcore.h", "embree4/rtcore.h", "OpenImageIO/imageio.h",
                       "sqlite3.h", "httplib.h"):
            self.write("engine/base/bad.cpp", f"#include <{header}>\n")
            self.expect_one(self.includes(), "engine/base/bad.cpp", header)

    def test_an_include_that_is_not_written_from_the_root(self):
        self.write("engine/scene/bad.cpp", '#  include "scene.h"\n')
        self.expect_one(self.includes(), "not written from the root")

    def test_a_source_that_no_target_compiles(self):
        self.write("build/compile_commands.json", json.dumps(
            [{"directory": str(self.root / "build"), "file": "../engine/visibility/rays.cpp", "command": "c++"}]))
        self.assertEqual(checks.sources_are_built(self.root, self.root / "build"), [])
        self.write("engine/scene/left_out.cpp", "")
        self.expect_one(checks.sources_are_built(self.root, self.root / "build"), "left_out.cpp")

    def commands(self, *paths):
        self.write("build/compile_commands.json", json.dumps(
            [{"directory": str(self.root), "file": path, "command": "c++ -o lib/CMakeFiles/one.dir/x.o"} for path in paths]))

    def test_two_sources_of_a_target_with_the_same_name_of_their_own(self):
        self.write("engine/scene/one.cpp", "namespace {\n\nint size_of(int x) {\n  return at(x);\n}\n\n}  // namespace\n")
        self.write("engine/scene/two.cpp", "namespace {\nconstexpr int kMost = 2;\n\n}  // namespace\n\nint size_of(int x) {\n}\n")
        self.write("build/Unity/unity_0_cxx.cxx", "".join(
            f'#include "{self.root}/engine/scene/{name}.cpp"\n' for name in ("one", "two")))
        for files in (("engine/scene/one.cpp", "engine/scene/two.cpp"), ("build/Unity/unity_0_cxx.cxx",)):
            self.commands(*files)
            self.assertEqual(checks.own_names(self.root, self.root / "build"), [])
            self.assertEqual([problem for problem in checks.sources_are_built(self.root, self.root / "build")
                              if "engine/scene" in problem], [])
        for line in ("double size_of(double x) {", "struct size_of {", "std::vector<int> size_of("):
            self.write("engine/scene/two.cpp", f"namespace {{\n\n{line}\n}}  // namespace\n")
            self.expect_one(checks.own_names(self.root, self.root / "build"), "two.cpp", "one.cpp", "size_of")
        self.write("engine/scene/box.h", "struct Box {\n};\n")
        self.write("engine/scene/two.cpp", "namespace {\n\nstruct Box {\n\n}  // namespace\n")
        self.expect_one(checks.own_names(self.root, self.root / "build"), "two.cpp", "box.h", "Box")

    def test_a_test_without_label_or_limit_or_that_nobody_runs(self):
        def listed(name, labels, timeout):
            return {"name": name, "command": ["python3", "job_test.py"],
                    "properties": [{"name": "LABELS", "value": labels}, {"name": "TIMEOUT", "value": timeout}]}
        good = listed("a", ["unit"], 10)
        self.assertEqual(checks.tests_are_registered(self.root, [good]), [])
        self.expect_one(checks.tests_are_registered(self.root, [good, listed("b", [], 10)]), "test b", "label")
        self.expect_one(checks.tests_are_registered(self.root, [good, listed("c", ["unit", "accuracy"], 10)]), "test c")
        self.expect_one(checks.tests_are_registered(self.root, [good, listed("d", ["unit"], 0)]), "test d", "limit")
        self.expect_one(checks.tests_are_registered(self.root, []), "job_test.py")
        self.write("tests/browser/page_test.mjs", "")
        self.expect_one(checks.tests_are_registered(self.root, [good]), "page_test.mjs")

    def test_a_long_file(self):
        self.write("engine/base/long.cpp", "\n" * 401)
        self.expect_one(checks.file_lengths(self.root, HERE / "long_files.txt"), "long.cpp: 401 lines")

    def test_a_long_script(self):
        self.write("server/dashboard/src/long.ts", "\n" * 401)
        self.expect_one(checks.file_lengths(self.root, HERE / "long_files.txt"), "long.ts: 401 lines")

    def test_a_script_that_is_not_laid_out(self):
        self.write("server/dashboard/src/a.ts", "/**\n * why\n */\nexport function f() {\n  return 1;\n}\n")
        self.assertEqual(checks.dashboard_layout(self.root), [])
        for text in ("\tx();\n", "x(); \n", " x();\n", f"x({'1' * 200});\n", "x();"):
            self.write("server/dashboard/src/bad.ts", text)
            self.expect_one(checks.dashboard_layout(self.root), "bad.ts")

    def test_a_script_or_style_that_nothing_imports(self):
        self.write("server/dashboard/src/main.ts", 'import "./a/a.css";\nimport { x } from "./a/b";\nimport("./a/c");\n')
        for name in ("a.css", "b.ts", "c.ts", "live_worker.ts"):
            self.write(f"server/dashboard/src/a/{name}", "\n")
        self.assertEqual(checks.dashboard_imports(self.root), [])
        self.write("server/dashboard/src/a/left_out.ts", "\n")
        self.expect_one(checks.dashboard_imports(self.root), "left_out.ts: nothing imports it")

    @unittest.skipIf(checks.clang_format_version() is None, "no clang-format here")
    def test_a_source_that_is_not_laid_out(self):
        shutil.copy(HERE.parent.parent / ".clang-format", self.root)
        self.assertEqual(checks.layout(self.root), [])
        self.write("engine/base/bad.cpp", "int  f( ){return 1;}\n")
        self.expect_one(checks.layout(self.root), "bad.cpp")

    def test_words_that_tell_of_somebodys_machine(self):
        for text in ("see /" + "home/someone/x", "curl https:" + "//files.example.org/x", "TO" + "DO: later"):
            self.write("engine/base/bad.h", f"// {text}\n")
            self.expect_one(self.words(), "engine/base/bad.h:1")
            (self.root / "engine/base/bad.h").unlink()
            self.expect_one(self.words(messages=text), "commit message")

    def test_a_document_that_names_what_is_not_there(self):
        readme = GOOD["README.md"]
        self.write("README.md", readme.replace("server/run\n", "server/start\n"))
        self.expect_one(checks.documents(self.root), "no such command: server/start")
        self.write("README.md", readme.replace("scene.h", "gone.h"))
        self.expect_one(checks.documents(self.root), "no such path: engine/scene/gone.h")
        self.write("README.md", readme.replace("| 1 | bug |\n", ""))
        self.expect_one(checks.documents(self.root), "exit codes")


if __name__ == "__main__":
    unittest.main()
