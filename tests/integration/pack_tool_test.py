#!/usr/bin/env python3
"""meshfront-pack: info adds up, dump agrees with the mesh, and an export behind a plain host of
static files answers what the service answers.

  pack_tool_test.py FOLDER-OF-PROGRAMS
"""

import json
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

programs = pathlib.Path(sys.argv[1])


def check(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def run(*command, status=0):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    check(done.returncode == status, f"status {status} instead of {done.returncode}: {command}\n{done.stderr}")
    return done.stdout if status == 0 else done.stderr


def pack_tool(*arguments, status=0):
    return run(programs / "meshfront-pack", *arguments, status=status)


def write_mesh(path):
    """A wavy sheet with a hole and colours: 2,400 triangles, virtual vertices."""
    size = 36
    lines = ["ply", "format ascii 1.0", f"element vertex {size * size}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"property uchar {name}" for name in ("red", "green", "blue")]
    faces = []
    for x in range(size - 1):
        for y in range(size - 1):
            if 14 < x < 18 and 10 < y < 20:
                continue
            a, b = x * size + y, (x + 1) * size + y
            faces += [f"3 {a} {b} {b + 1}", f"3 {a} {b + 1} {a + 1}"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    for x in range(size):
        for y in range(size):
            lines.append(f"{x} {y} {(x * x + 3 * y * x) % 17 * 0.1:.3f} {7 * x % 256} {5 * y % 256} {x * y % 256}")
    path.write_text("\n".join(lines + faces) + "\n")


def test_info(pack):
    info = json.loads(pack_tool("info", pack, "--json"))
    metadata = info["metadata"]
    leaves = info["leavesByDepth"]
    check(sum(leaves) == metadata["vertexCount"], "each vertex is a leaf")
    check(len(leaves) - 1 == metadata["maxDepth"], "the deepest leaf is the deepest node")
    ids = info["nodeIds"]
    mean = sum(depth * count for depth, count in enumerate(leaves)) / sum(leaves)
    check(abs(ids["meanDepth"] - mean) < 1e-9, "the mean depth is that of the leaves")
    trees = info["base"]["roots"] + info["base"]["virtualTrees"]
    check(2 ** ids["treeBits"] >= trees > 2 ** ids["treeBits"] // 2, f"{ids['treeBits']} bits tell {trees} trees apart")
    check(ids["within32Bits"] == (ids["treeBits"] + ids["maxDepth"] <= 32), "IDs of 32 bits")
    base = info["base"]
    parts = sum(base[part] for part in ("tableBits", "rootBits", "triangleBits", "otherBits"))
    check(parts == 8 * base["bytes"] == 8 * metadata["baseBytes"], "the parts of the base add up")
    chunks = info["chunks"]
    check((chunks["count"], chunks["bytes"]) == (metadata["chunkCount"], metadata["chunkBytes"]), "all chunks")
    for total in ("count", "bytes"):
        check(sum(band[total] for band in chunks["byBand"]) == chunks[total], "bands add up")
    check(len(chunks["byBand"]) == metadata["maxLevel"] + 1, "a band a level")
    fields = info["bitsByField"]
    parts = ("header", "significance", "positionClasses", "positionValues", "colours", "normals", "cutRegions")
    check(sum(fields[part]["bits"] for part in parts) == fields["total"]["bits"], "fields add up")
    check(abs(fields["total"]["bits"] - 8 * metadata["recordBytes"]) < 8, "to all records")
    check(info["attributes"] == {"colours": True, "normalBits": 0}, "what it carries")
    text = pack_tool("info", pack)
    for words in (metadata["revision"], f"{fields['total']['bits']:>12}", "within 32 bits: yes", "boundary loops",
                  f"{len(leaves) - 1:>5} {leaves[-1]:>10} #", "not carried", "colours"):
        check(words in text, f"'{words}' is not in:\n{text}")
    print(text, end="")
    return info


def children_of(dump):
    return [dump[side] for side in ("left", "right")]


def test_dump(pack, info):
    """Walks down from every root: what a record says of its children, their records take up."""
    random.seed(1)
    dumped = 0
    deepest = 0
    for tree in random.sample(range(info["base"]["roots"]), min(12, info["base"]["roots"])):
        name = f"{tree}:"
        while name:
            dump = json.loads(pack_tool("dump", pack, name, "--json"))
            dumped += 1
            check(dump["id"] == name and dump["bitLength"] == len(dump["bits"]), f"the record of {name}")
            check(sum(dump["fieldBits"].values()) == dump["bitLength"], f"the fields of {name} add up")
            check(dump["bits"].endswith(dump["cut"]["region"]), "the cut region comes last")
            ring = dump["cut"]["ring"]
            check(0 <= dump["cut"]["left"] < len(ring) and 0 <= dump["cut"]["right"] < len(ring), "l and r are in the ring")
            check(all(name != entry["id"] for entry in ring), "the node is not its own neighbour")
            left, right = children_of(dump)
            moved = [t - s for s, t in zip(left["grid"], right["grid"])]
            check(moved == dump["delta"], f"right stands at left + d in {name}")
            step, origin = (info["metadata"]["quantization"][key] for key in ("step", "origin"))
            world = [o + step * g for o, g in zip(origin, right["grid"])]
            check(all(abs(a - b) < 1e-9 for a, b in zip(world, right["world"])), "world positions")
            check(len(right["attributes"]["colour"]) == 4, "colours are shown")
            if dumped % 5 == 1:
                text = pack_tool("dump", pack, name)
                check(f"chunk {dump['chunk']}, bits {dump['bitOffset']} + {dump['bitLength']}" in text, text)
            deepest = max(deepest, len(name) - name.index(":") - 1)
            for child in children_of(dump):
                if child["isLeaf"]:
                    check("leaf" in pack_tool("dump", pack, child["id"], status=1), "leaves are told")
                    check("above it is a leaf" in pack_tool("dump", pack, child["id"] + "1", status=1), "nothing below")
            inner = [child for child in children_of(dump) if not child["isLeaf"]]
            if inner:
                following = random.choice(inner)
                below = json.loads(pack_tool("dump", pack, following["id"], "--json"))
                check(below["level"] == following["level"], "a child has the level its parent tells")
                check(below["left"]["grid"] == following["grid"], "and stands where its parent puts it")
            name = following["id"] if inner else None
    print(f"dumped {dumped} records down to depth {deepest}")
    check(dumped > 20 and deepest > 3, "the hierarchy is deep enough to test anything")
    virtual = info["base"]["roots"]
    for node, words in ((f"{virtual}:", "virtual vertex"), ("999999:", "there is no tree"), ("0", "no colon"),
                        ("x:0", "no tree number"), ("0:02", "neither 0 nor 1"), ("-1:", "no tree number"),
                        ("0:" + "0" * 64, "deeper")):
        check(words in pack_tool("dump", pack, node, status=1), f"{node}: {words}")


class Server:
    def __init__(self, *command):
        self.process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        match = re.search(r"(?:on 127\.0\.0\.1 port |127\.0\.0\.1:)(\d+)", self.process.stdout.readline())
        check(match, f"{command[0]} listens")
        self.origin = f"http://127.0.0.1:{match.group(1)}"

    def get(self, path):
        with urllib.request.urlopen(self.origin + path) as response:
            return response.read()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait()
        self.process.stdout.close()


def tree_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_static_host(pack, folder, metadata):
    said = pack_tool("export", pack, folder)
    files = tree_of(folder)
    check(f"{len(files)} files" in said, said)
    self_link = f"/v1/meshes/{metadata['name']}"
    urls = ["/v1/meshes", self_link, metadata["links"]["base"], metadata["links"]["chunks"]]
    urls += [metadata["links"]["chunk"].replace("{n}", str(n)) for n in range(metadata["chunkCount"])]
    service = Server(programs / "meshfront-serve", "--packs", pack.parent, "--listen", "127.0.0.1:0")
    host = Server(sys.executable, "-u", "-m", "http.server", "0", "--bind", "127.0.0.1", "--directory", folder)
    try:
        for url in urls:
            check(service.get(url) == host.get(url), f"the service and the static host answer alike to {url}")
    finally:
        service.stop()
        host.stop()
    for index in [path for path in files if path.endswith("index.html")]:
        other = index.replace("index.html", "index.bin" if "chunks/" in index else "index.json")
        check(files[index] == files.pop(other), f"{other} is the same")
    check(len(files) == len(urls) + 1, f"no other files than those of {len(urls)} URLs and a note")
    print(f"a static host answers {len(urls)} URLs like the service")
    return tree_of(folder)


def test_replacing(pack, other_pack, folder, exported):
    parent = folder.parent
    check(sorted(p.name for p in parent.iterdir()) == [folder.name], "nothing else is left")
    pack_tool("export", other_pack, folder)
    check(tree_of(folder) != exported, "an earlier export is replaced")
    pack_tool("export", pack, str(folder) + "/")
    check(tree_of(folder) == exported, "whole, nothing of the other one is left")
    foreign = parent / "foreign"
    foreign.mkdir()
    pack_tool("export", pack, foreign)
    check(tree_of(foreign) == exported, "an empty folder is taken")
    (foreign / ".meshfront-export").unlink()
    (foreign / "mine").write_text("mine")
    check("--force" in pack_tool("export", pack, foreign, status=1), "a foreign folder is refused")
    check((foreign / "mine").read_text() == "mine", "and untouched")
    pack_tool("export", pack, foreign, "--force")
    check(tree_of(foreign) == exported, "--force replaces it")
    file = parent / "file"
    file.write_text("mine")
    for refused in (file, parent / "none" / "deep", "/"):
        pack_tool("export", pack, refused, status=1)
        pack_tool("export", pack, refused, "--force", status=1)
    check(file.read_text() == "mine", "a file is untouched")
    linked = parent / "linked"
    linked.symlink_to(folder)
    pack_tool("export", other_pack, linked)
    check(linked.is_symlink() and tree_of(folder) != exported, "a link is followed")
    check(len(list(parent.iterdir())) == 4, f"nothing else is left: {list(parent.iterdir())}")


def test_interrupts(pack, folder):
    """Whenever it is stopped, the folder is as it was or whole."""
    command = [programs / "meshfront-pack", "export", pack, folder]
    started = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    whole = time.monotonic() - started
    exported = tree_of(folder)
    early = 0
    for attempt in range(12):
        pack_tool("export", pack, folder)
        (folder / "old").write_text("old")
        before = tree_of(folder)
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        time.sleep(whole * attempt / 12)
        which = signal.SIGTERM if attempt % 2 else signal.SIGINT
        process.send_signal(which)
        status = process.wait()
        check(status in (0, -which), f"ended by the signal or well, not with {status}")
        early += status != 0
        check(tree_of(folder) == (exported if status == 0 else before), "all or nothing")
        check([p.name for p in folder.parent.iterdir()] == [folder.name], "nothing else is left")
    print(f"{early} of 12 interrupts came in time, nothing was left behind")


with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    for folder in ("packs", "others", "exports", "interrupted"):
        (work / folder).mkdir()
    mesh = work / "sheet.ply"
    write_mesh(mesh)
    pack = work / "packs" / "sheet.pack"
    other = work / "others" / "other.pack"
    run(programs / "meshfront-encode", mesh, "--output", pack)
    run(programs / "meshfront-encode", mesh, "--output", other, "--quantization", "10", "--no-colours")
    information = test_info(pack)
    test_dump(pack, information)
    exported = test_static_host(pack, work / "exports" / "site", information["metadata"])
    test_replacing(pack, other, work / "exports" / "site", exported)
    test_interrupts(pack, work / "interrupted" / "site")
