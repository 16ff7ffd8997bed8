#!/usr/bin/env python3
"""FindHttplib.cmake refuses a header that is too old, says what to do, and takes one that is new enough."""
import subprocess
import tempfile
import unittest
from pathlib import Path

MODULES = Path(__file__).resolve().parent.parent.parent / "server/cmake"
PROJECT = f"""cmake_minimum_required(VERSION 3.22)
project(probe NONE)
list(APPEND CMAKE_MODULE_PATH {MODULES})
function(find_package)
  if(ARGV0 STREQUAL Threads)
    add_library(Threads::Threads INTERFACE IMPORTED)
  else()
    _find_package(${{ARGV}})
  endif()
endfunction()
find_package(Httplib REQUIRED)
"""


class FindHttplib(unittest.TestCase):
    def configure(self, version):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "CMakeLists.txt").write_text(PROJECT)
            Path(folder, "header").mkdir()
            Path(folder, "header/httplib.h").write_text(f'#define CPPHTTPLIB_VERSION "{version}"\n')
            return subprocess.run(["cmake", "-S", folder, "-B", f"{folder}/b", f"-DKEYLUME_HTTPLIB_DIR={folder}/header"],
                                  capture_output=True, text=True)

    def test_refuses_the_version_of_debian_12_and_says_what_to_do(self):
        run = self.configure("0.11.4")
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("version '0.11.4': too old", run.stderr)
        self.assertIn("server/get_httplib", run.stderr)

    def test_compares_versions_as_numbers(self):
        self.assertNotEqual(self.configure("0.9.0").returncode, 0)

    def test_takes_one_that_is_new_enough(self):
        for version in ("0.41.0", "0.53.1", "1.0"):
            run = self.configure(version)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(f"cpp-httplib {version}", run.stdout)


if __name__ == "__main__":
    unittest.main()
