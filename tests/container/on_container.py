#!/usr/bin/env python3
"""Runs a script of tests/browser against the image.  usage: on_container.py SCRIPT [ARGUMENT...]"""
import os
import sys
from pathlib import Path

import container_engine  # noqa: F401  (says where Docker is, or ends as skipped)

BROWSER = Path(__file__).resolve().parent.parent / "browser"

os.chdir(BROWSER)
os.execv(sys.executable, [sys.executable, "-B", str(BROWSER / sys.argv[1]), *sys.argv[2:]])
