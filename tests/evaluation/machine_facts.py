"""Where an evaluation was run: what a stranger needs to judge its times."""

import os
import pathlib
import platform
import re
import subprocess


def first_match(path, pattern):
    try:
        found = re.search(pattern, pathlib.Path(path).read_text(), re.MULTILINE)
    except OSError:
        return None
    return found.group(1).strip() if found else None


def commit(root):
    def git(*words):
        done = subprocess.run(["git", "-C", root, *words], capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else None

    name = git("rev-parse", "--short=12", "HEAD")
    if name is None:
        return "not a git checkout"
    return name + (", with local changes" if git("status", "--porcelain", "--untracked-files=no") else "")


def build_type(build):
    return first_match(build / "CMakeCache.txt", r"^CMAKE_BUILD_TYPE:\w+=(.*)$") or "not said"


def machine_facts(root, build):
    memory = first_match("/proc/meminfo", r"^MemTotal:\s*(\d+) kB")
    model = first_match("/proc/cpuinfo", r"^model name\s*:(.*)$") or platform.machine()
    system = first_match("/etc/os-release", r'^PRETTY_NAME="?([^"\n]*)"?') or platform.system()
    return {
        "meshfront": f"commit {commit(root)}, {build_type(build)} build",
        "CPU": f"{len(os.sched_getaffinity(0))} cores of {model}",
        "Memory": f"{int(memory) / 2**20:.1f} GiB" if memory else "not said",
        "System": f"{system}, Linux {platform.release()}",
    }
