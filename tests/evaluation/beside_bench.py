"""Lets this folder's scripts import what tests/bench has: programs served, nginx, views."""

import pathlib
import sys

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(TESTS / "bench"))
