"""Where the tests of tests/container find the Engine and the image that tests/container/image_setup.py has made.
Importing it puts them into the environment; where there is no Engine it ends the program as skipped."""
import json
import os
import sys
from pathlib import Path

FOLDER = Path(os.environ["KEYLUME_CONTAINER_FOLDER"])
SKIPPED = 77

if not (FOLDER / "environment.json").is_file():
    print("skipped: no Docker Engine here (the test container.image says why)")
    sys.exit(1 if os.environ.get("CI") == "true" else SKIPPED)
os.environ.update(json.loads((FOLDER / "environment.json").read_text()))
