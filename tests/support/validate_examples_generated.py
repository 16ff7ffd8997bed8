#!/usr/bin/env python3
"""Runs an example's make_scene.py into an empty folder and compares every file with the committed one.

usage: validate_examples_generated.py NAME
"""

import pathlib
import subprocess
import sys
import tempfile

folder = pathlib.Path(__file__).resolve().parents[2] / "api" / "examples" / sys.argv[1]
with tempfile.TemporaryDirectory() as made_name:
    made = pathlib.Path(made_name)
    subprocess.run([sys.executable, folder / "make_scene.py", made], check=True)
    names = sorted(path.name for path in made.iterdir())
    committed = sorted(path.name for path in folder.iterdir() if path.suffix in (".obj", ".mtl", ".json"))
    if names != committed:
        sys.exit(f"the generator writes {names}, committed are {committed}")
    for name in names:
        if (made / name).read_bytes() != (folder / name).read_bytes():
            sys.exit(f"{folder / name} is not what make_scene.py writes: run it again and commit the result")
print(f"{len(names)} files agree")
