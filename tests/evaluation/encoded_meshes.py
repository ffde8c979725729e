"""Meshes by their names, and the packs that the encoder makes of them."""

import sys

import beside_bench  # noqa: F401  (finds tests/bench)
from served_programs import run


def succeed(*command):
    """What it prints. Where it fails, so does this program."""
    done = run(*command)
    if done.returncode != 0:
        sys.exit(f"{command[0]}: {done.stderr.strip()}")
    return done.stdout


def mesh_name(path):
    return path.name.split(".")[0]


def encode(programs, mesh, pack, *options):
    """What the encoder prints."""
    return succeed(programs / "meshfront-encode", mesh, "--output", pack, *options)
