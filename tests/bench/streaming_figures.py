#!/usr/bin/env python3
"""Prints the figures of the README for mesh files: what a record costs and how fast a picture comes.

  streaming_figures.py [--bin build/bin] [--views whole half close] [--targets 35 40] MESH...

For each mesh: encodes it, serves it, puts the proxy in front, and then
  - streams it until it is complete and compares the export with the input;
  - for each view and ranking, streams it until it has settled, at 500x500 against the input, and
    tells the records needed to each PSNR in dB.
Tables in Markdown on stdout. Exit status 1 if a stream did not end with the exact mesh.
"""

import argparse
import json
import pathlib
import sys
import tempfile

from served_programs import Server, run


def view(programs, url, *options):
    done = run(programs / "meshfront-view", url, "--headless", "--size", "500x500", "--json", *options)
    if done.returncode != 0:
        sys.exit(f"meshfront-view {url}: {done.stderr}")
    return json.loads(done.stdout)


def table(title, header, rows):
    print(f"\n{title}\n\n| " + " | ".join(header) + " |")
    print("|---" * len(header) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    sys.stdout.flush()


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    arguments.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    arguments.add_argument("--views", nargs="*", default=["whole", "half", "close"])
    arguments.add_argument("--targets", nargs="*", type=float, default=[35, 40])
    arguments.add_argument("--batch", default="0", help="records a request while looking for targets; 0: as many as the viewer takes")
    options = arguments.parse_args()
    programs = options.bin
    costs, exact, pictures = [], [], []
    wrong = False
    with tempfile.TemporaryDirectory() as folder:
        packs = pathlib.Path(folder)
        for mesh in options.meshes:
            name = mesh.stem
            encoded = run(programs / "meshfront-encode", mesh, "--output", packs / f"{name}.pack", "--json")
            if encoded.returncode != 0:
                sys.exit(encoded.stderr)
            report = json.loads(encoded.stdout)
            bits = report["bitsPerSplit"]
            seconds = sum(phase["seconds"] for phase in report["phases"])
            peak = max(phase["peakMiB"] for phase in report["phases"])
            costs.append(
                [name]
                + [f"{bits[k]:.2f}" for k in ("cutRegionsWithLength", "leafFlags", "significance", "position", "total")]
                + [str(report["metadata"]["baseBytes"]), str(report["maxDepth"]), f"{seconds:.2f}", f"{peak:.0f}"]
            )
        with Server(programs / "meshfront-serve", "--packs", packs, "--listen", "127.0.0.1:0") as service, Server(
            programs / "meshfront-proxy", "--upstream", service.url, "--listen", "127.0.0.1:0"
        ) as proxy:
            for mesh in options.meshes:
                url = f"{proxy.url}/v1/meshes/{mesh.stem}"
                export = packs / f"{mesh.stem}.ply"
                whole = view(programs, url, "--until", "complete", "--export", export, "--batch", "2000")
                compared = run(programs / "meshfront-pack", "compare", mesh, export)
                wrong |= compared.returncode != 0
                exact.append(
                    [
                        mesh.stem,
                        compared.stdout.strip() or compared.stderr.strip(),
                        f"{8 * whole['set_octets'] / whole['ids_requested']:.2f}",
                        str(whole["requests"]),
                        str(whole["bytes_up"]),
                        str(whole["bytes_down"]),
                        f"{whole['seconds']:.1f}",
                    ]
                )
                export.unlink(missing_ok=True)
                for camera in options.views:
                    for ranking in ("significance", "pixels"):
                        row = [mesh.stem, camera, ranking]
                        settled = None
                        for target in options.targets:
                            settled = view(
                                programs, url, "--camera", camera, "--rank", ranking, "--batch", options.batch,
                                "--reference", mesh, "--psnr-target", f"{target}",
                            )
                            reached = settled["psnr_target"]
                            row.append(
                                f"{reached['records']} ({100 * reached['share']:.1f} %, {reached['bytes_down']} B)"
                                if reached["reached"]
                                else "-"
                            )
                        if settled:
                            row += [f"{settled['psnr']:.1f} dB", f"{100 * settled['share']:.1f} %"]
                        pictures.append(row)
    table(
        "Bits a record; base in bytes; deepest node; encoding in seconds and peak MiB",
        ["mesh", "cut code, length", "leaf flags", "significance", "position", "total", "base", "depth", "s", "MiB"],
        costs,
    )
    table(
        "Streamed until complete through the proxy, batches of 2,000, against the input",
        ["mesh", "result", "bits an ID", "requests", "bytes up", "bytes down", "s"],
        exact,
    )
    if pictures:
        table(
            f"Records to a PSNR (500x500, batches of {options.batch}), then when settled: PSNR and records received",
            ["mesh", "view", "ranking"] + [f"{t:g} dB" for t in options.targets] + ["settled", "of all"],
            pictures,
        )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
