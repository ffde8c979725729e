#!/usr/bin/env python3
"""meshfront-encode as it is used: one revision on any number of threads, an honest estimate of
memory and a refusal where there is too little, nothing left behind by an interrupt, a progress bar
on a terminal only.

  encoder_use_test.py FOLDER-OF-PROGRAMS
"""

import json
import os
import pathlib
import pty
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

programs = pathlib.Path(sys.argv[1])
encode = programs / "meshfront-encode"


def check(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def make_sphere(folder, vertices):
    path = folder / f"sphere{vertices}.ply"
    subprocess.run(
        [programs / "write-fractal-sphere", "--vertices", str(vertices), "--output", path],
        check=True, stdout=subprocess.DEVNULL,
    )
    return path


def report_of(mesh, pack, *options):
    done = subprocess.run(
        [encode, mesh, "--output", pack, "--json", *options], capture_output=True, text=True, check=True
    )
    check(done.stderr == "", f"no progress on a pipe, but: {done.stderr}")
    return json.loads(done.stdout)


def test_threads(folder, mesh):
    revisions = {
        report_of(mesh, folder / "threads.pack", "--threads", str(threads))["metadata"]["revision"]
        for threads in (1, 2, 5)
    }
    (folder / "threads.pack").unlink()
    check(len(revisions) == 1, f"one revision on 1, 2 and 5 threads, not {revisions}")
    print("1, 2 and 5 threads: revision", *revisions)


def sanitized():
    # Sanitizers take memory of their own.
    return b"__asan_init" in encode.read_bytes() or b"__tsan_init" in encode.read_bytes()


def test_memory(folder, meshes):
    for mesh in meshes:
        report = report_of(mesh, folder / "memory.pack")
        (folder / "memory.pack").unlink()
        check([p["name"] for p in report["phases"]] == ["read", "clean", "simplify", "hierarchy", "code", "write"],
              "all phases are told")
        peak = max(phase["peakMiB"] for phase in report["phases"])
        estimated = report["estimatedPeakMiB"]
        print(f"{mesh.name}: peak {peak:.1f} MiB, estimated {estimated:.1f} MiB")
        if not sanitized():
            check(0.7 * peak < estimated < 1.3 * peak, "the estimate is within 30 %")

    def refused(told, *options, **more):
        done = subprocess.run([encode, meshes[-1], "--output", folder / "refused.pack", *options],
                              capture_output=True, text=True, **more)
        check(done.returncode == 1, f"status 1 instead of {done.returncode}: {done.stderr}")
        for words in (str(meshes[-1]), "needs about", told):
            check(words in done.stderr, f"'{words}' is not in: {done.stderr}")
        check(not (folder / "refused.pack").exists(), "no pack")

    refused("--memory-limit leaves 20 MiB", "--memory-limit", "20MiB")
    if not sanitized():
        limit = 60 << 20
        refused("ulimit -v", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    done = subprocess.run([encode, meshes[0], "--output", folder / "none" / "a.pack"], capture_output=True, text=True)
    check(done.returncode == 1 and "none" in done.stderr, "a missing folder is found before the work")


def test_interrupts(folder, mesh):
    target = folder / "interrupted"
    target.mkdir()
    pack = target / "a.pack"
    command = [encode, mesh, "--output", pack]
    whole = float("inf")
    for _ in range(3):  # the quickest, as the first one may wait for the disk
        started = time.monotonic()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        whole = min(whole, time.monotonic() - started)
    content = pack.read_bytes()
    random.seed(1)
    ended_early = 0
    for attempt in range(16):
        for path in target.iterdir():
            path.unlink()
        old = attempt % 4 == 3  # a pack of that name is there and stays as it was
        if old:
            pack.write_bytes(b"old")
        which = signal.SIGTERM if attempt % 5 == 4 else signal.SIGINT
        # Half of them strike while the pack is written.
        delay = whole * random.uniform(0, 1.05) if attempt % 2 else whole * random.uniform(0.9, 1.05)
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        time.sleep(delay)
        process.send_signal(which)
        status = process.wait()
        left = sorted(path.name for path in target.iterdir())
        if status == 0:
            check(left == ["a.pack"] and pack.read_bytes() == content, f"all of it, not {left}")
            continue
        ended_early += 1
        check(status == -which, f"ended by the signal, not with {status}")
        check(left == (["a.pack"] if old else []), f"nothing new is left, not {left}")
        check(not old or pack.read_bytes() == b"old", "the old pack is untouched")
    print(f"16 interrupts within {1.05 * whole:.2f} s: {ended_early} came in time, nothing was left behind")
    check(ended_early >= 1, "some interrupts come in time")


def test_progress_bar(folder, mesh):
    leader, follower = pty.openpty()
    process = subprocess.Popen(
        [encode, mesh, "--output", folder / "bar.pack", "--threads", "1"], stdout=subprocess.DEVNULL, stderr=follower
    )
    os.close(follower)
    shown = b""
    while True:
        try:
            piece = os.read(leader, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    check(process.wait() == 0, "encoded")
    text = shown.decode()
    check("%" in text and " left" in text, f"a bar with the time left: {text!r}")
    check(text.endswith("\r\x1b[K"), "which is gone in the end")
    print("bar on a terminal:", text.split("\r\x1b[K")[-2])


with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    small = make_sphere(work, 30000 if sanitized() else 120000)
    large = make_sphere(work, 150000 if sanitized() else 700000)  # over two seconds of work
    test_threads(work, small)
    test_memory(work, [small, large])
    test_interrupts(work, small)
    test_progress_bar(work, large)
