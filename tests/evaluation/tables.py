#!/usr/bin/env python3
"""Experiment 7: bits and depths of IDs by balance, bits by field, splits a second.

  tables.py --output DIR [--bin build/bin] [--short] MESH...

Encodes each mesh with --balance 0, 1 and 2 (in the short form 0 and 1); the other figures are of
the default, 1. Writes DIR/tables: ids.csv, depths.csv, fields.csv, speed.csv, figures.json and plots.json.
"""

import json
import math
import pathlib
import re
import sys
import tempfile

from encoded_meshes import encode, mesh_name, succeed
from experiment_command import experiment_parser
from experiment_files import ExperimentFiles

# What a record is made of, and what stands beside it: Cheng and Ooi 2008, section 5.2, on the Happy Buddha.
FIELDS = (
    ("cut code, with its length", ("cutRegionsWithLength",), 11),
    ("leaf flags", ("leafFlags",), None),
    ("significance", ("significance",), None),
    ("position", ("position",), 20),
    ("colours and normals", ("colours", "normals"), None),
    ("total", ("total",), 31),
)
NO_KIM = ("Table 1 of the publication (Kim, Lee, Kobbelt 2004) could not be had, so that nothing of it stands here. "
          "--balance 0 is an order by error alone, 1 and 2 multiply the error by a power of the subtree's height.")
BUDDHA = ("Published: Happy Buddha, 542,652 splits (Cheng and Ooi 2008). Ours carry leaf flags and significance, "
          "which theirs do not.")
TOTAL = (BUDDHA + " Hoppe's Tables 3 and 4 (1998) could not be had; his own program's estimate for the same meshes on the "
         "same grid, in one order that needs no IDs, was once measured as 29.3 (bunny), 27.3 (horse), 26.6 (igea) and "
         "28.1 (gcanyon600) bits a vertex.")
SPEED = ("Parsed, decoded and applied from bytes as they come. Hoppe's Table 2 (1998) could not be had; his FilterPM, "
         "which applies splits that are decoded already and in one order, once reached 8.3 (bunny), 4.4 (igea) and 3.3 "
         "(gcanyon600) million/s on a machine like this.")
AGAIN = "What the viewer does when a view needs again what was collapsed: nothing is decoded."


def measure_ids(programs, packs, mesh, balances, files):
    """Encodes the mesh once for each balance; the pack of balance 1 is kept."""
    name = mesh_name(mesh)
    for balance in balances:
        pack = packs / f"{name}-{balance}.pack"
        encoded = json.loads(encode(programs, mesh, pack, "--balance", balance, "--json"))
        info = json.loads(succeed(programs / "meshfront-pack", "info", pack, "--json"))
        ids, leaves = info["nodeIds"], info["leavesByDepth"]
        ideal = math.log2(max(1, info["metadata"]["vertexCount"] / info["base"]["roots"]))
        files.add("ids.csv", {
            "mesh": name, "balance": balance, "vertices": info["metadata"]["vertexCount"], "trees": info["base"]["roots"],
            "tree_bits": ids["treeBits"], "deepest": ids["maxDepth"], "mean_depth": ids["meanDepth"],
            "ideal_depth": round(ideal, 2), "id_bits_most": ids["maxBits"], "id_bits_mean": ids["meanBits"],
            "within_32_bits": ids["within32Bits"], "bits_a_split": encoded["bitsPerSplit"]["total"],
        })
        for depth, count in enumerate(leaves):
            files.add("depths.csv", {"mesh": name, "balance": balance, "depth": depth, "leaves": count})
        if balance != 1:
            pack.unlink()
    return packs / f"{name}-1.pack"


def tell_ids(files):
    for row in files.rows("ids.csv"):
        where = {"table": "IDs and depths by balance", "row": f"{row['mesh']}, balance {row['balance']}", "csv": "ids.csv"}
        files.figure(7, **where, column="deepest node", value=row["deepest"], unit="levels", note=NO_KIM)
        files.figure(7, **where, column="mean depth of a leaf", value=row["mean_depth"], unit="levels")
        files.figure(7, **where, column="the same, all trees equal and full", value=row["ideal_depth"], unit="levels")
        files.figure(7, **where, column="longest ID", value=row["id_bits_most"], unit="bits")
        files.figure(7, **where, column="mean ID", value=row["id_bits_mean"], unit="bits")
        files.figure(7, **where, column="record", value=row["bits_a_split"], unit="bits")


def tell_fields(programs, pack, name, files):
    """The parts of a record as the encoder sums them up, and the raw fields in the CSV."""
    info = json.loads(succeed(programs / "meshfront-pack", "info", pack, "--json"))
    parts = info["report"]["bitsPerSplit"]
    base = 8 * info["base"]["bytes"] / info["metadata"]["splitCount"]
    fields = {f"field {key}": entry["perSplit"] for key, entry in info["bitsByField"].items()}
    for key, bits in {**parts, "base": base, **fields}.items():
        files.add("fields.csv", {"mesh": name, "part": key, "bits_a_split": round(bits, 4)})
    where = {"table": "Bits of a record by field", "column": name, "unit": "bits a split", "csv": "fields.csv"}
    for label, keys, published in FIELDS:
        bits = sum(parts[key] for key in keys)
        if bits > 0:
            note = TOTAL if label == "total" else BUDDHA if published else ""
            files.figure(7, **where, row=label, value=round(bits, 2), published=published, note=note)
    files.figure(7, **where, row="beside them: base mesh and code tables", value=round(base, 3))


def tell_speed(programs, packs_by_name, runs, files):
    """One thread, as refinement-bench prints it."""
    for name, pack in packs_by_name.items():
        out = succeed(programs / "refinement-bench", pack, "--runs", runs)
        for label, seconds, rate in re.findall(r"^  (\S.*?)\s+([\d.]+) s\s+([\d.]+) M/s", out, re.MULTILINE):
            files.add("speed.csv", {"mesh": name, "what": label, "seconds": seconds, "million_a_second": rate})
        for row in files.rows("speed.csv"):
            if row["mesh"] == name and row["what"].startswith(("split", "collapse")):
                kept = "collapse" in row["what"] or "again" in row["what"]
                files.figure(7, table="Splits a second, one thread", row=row["what"], column=name,
                             value=float(row["million_a_second"]), unit="million/s", csv="speed.csv",
                             note=AGAIN if kept else SPEED)


def main():
    options = experiment_parser(__doc__, "tables").parse_args()
    files = ExperimentFiles(options.output / "tables")
    with tempfile.TemporaryDirectory() as folder:
        packs = {}
        for mesh in options.meshes:
            name = mesh_name(mesh)
            packs[name] = measure_ids(options.bin, pathlib.Path(folder), mesh, (0, 1) if options.short else (0, 1, 2), files)
            print(f"{name}: encoded", flush=True)
        tell_ids(files)
        for name, pack in packs.items():
            tell_fields(options.bin, pack, name, files)
        tell_speed(options.bin, packs, 1 if options.short else 3, files)
        for name in packs:
            files.plot(f"depths_{name}", f"{name}: leaves by depth", "depth in the hierarchy", "leaves", [
                {"label": f"balance {balance}", "csv": "depths.csv", "where": {"mesh": name, "balance": balance},
                 "x_column": "depth", "y_column": "leaves"} for balance in ((0, 1) if options.short else (0, 1, 2))],
                caption=f"How deep the leaves of {name}'s hierarchy lie, by the encoder's --balance.")
    files.write()
    return 0


if __name__ == "__main__":
    sys.exit(main())
