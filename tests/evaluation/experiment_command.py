"""The command line of an experiment's script, as tests/evaluation/run gives it."""

import argparse
import pathlib


def experiment_parser(text, name):
    """For the script whose description begins `text`; it writes a folder `name`."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    parser.add_argument("--output", type=pathlib.Path, required=True, metavar="DIR", help=f"a folder {name} is written there")
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    parser.add_argument("--short", action="store_true")
    return parser
