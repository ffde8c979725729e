"""Imported for its effect: modules of the other test folders can then be imported too."""
import pathlib
import sys

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path += [str(TESTS / "format"), str(TESTS / "integration")]
