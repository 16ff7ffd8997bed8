#!/usr/bin/env python3
"""Writes animation.json: 100,000 brackets deep.

usage: make_animation.py [FOLDER]
"""

import pathlib
import sys

folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent
(folder / "animation.json").write_text('{"name":' + "[" * 100_000 + "]" * 100_000 + "}\n", encoding="utf-8")
