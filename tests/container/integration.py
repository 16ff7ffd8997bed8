#!/usr/bin/env python3
"""Runs one file of tests/integration against the image KEYLUME_CONTAINER.  usage: integration.py NAME_test.py
left_out.txt lists what cannot be asked of a container, and why; that is printed.
exit 0: passed; 1: failed; 77: all of it is left out"""
import importlib.util
import os
import sys
import unittest
from pathlib import Path

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)

HERE = Path(__file__).resolve().parent
INTEGRATION = HERE.parent / "integration"
SKIPPED = 77


def reasons():
    """-> {NAME_test.py, NAME_test.py:Class or NAME_test.py:test_name: why it is left out}"""
    found = {}
    for line in (HERE / "left_out.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            what, _, why = line.partition("  ")
            found[what] = why.strip()
    return found


def each_test(suite):
    for item in suite:
        if isinstance(item, unittest.TestSuite):
            yield from each_test(item)
        else:
            yield item


def main(name):
    left_out = reasons()
    if name in left_out:
        print(f"left out: {name}: {left_out[name]}")
        return SKIPPED
    os.chdir(INTEGRATION)
    sys.path.insert(0, str(INTEGRATION))
    spec = importlib.util.spec_from_file_location("tests_of_the_service", INTEGRATION / name)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    wanted, names = unittest.TestSuite(), set()
    for test in each_test(unittest.defaultTestLoader.loadTestsFromModule(module)):
        of_class, method = test.id().split(".")[-2:]
        names.update((f"{name}:{method}", f"{name}:{of_class}"))
        why = left_out.get(f"{name}:{method}") or left_out.get(f"{name}:{of_class}")
        if why:
            print(f"left out: {name}: {method}: {why}", flush=True)
        else:
            wanted.addTest(test)
    unknown = [what for what in left_out if what.startswith(f"{name}:") and what not in names]
    if unknown:
        print(f"left_out.txt names what is not there: {', '.join(unknown)}")
        return 1
    done = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(wanted)
    return 0 if done.wasSuccessful() and done.testsRun > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
