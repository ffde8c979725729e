"""Programs run and servers kept running while figures are taken."""

import subprocess
import sys


class Server:
    """A program that prints its address when it is ready, ended with the block."""

    def __init__(self, *command):
        self.process = subprocess.Popen(
            [str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        line = self.process.stdout.readline()
        if "listening on " not in line:
            sys.exit(f"{command[0]} did not start")
        self.url = line.split()[-1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)
