"""A server behind a link of a given round trip and bandwidth, and how the link is made: by the kernel
(tc with netem, in a network namespace of its own) where that is allowed and shown to work, else by
shaped_link.py."""

import contextlib
import os
import pathlib
import shutil
import subprocess
import sys

import link_probe
from served_programs import Server

RELAY = pathlib.Path(__file__).with_name("shaped_link.py")
INSIDE = "MESHFRONT_NETEM_NAMESPACE"  # set where the loopback device is ours to shape
QUEUE = 100_000  # packets: nothing is to be lost


def port_of(url):
    return int(url.rsplit(":", 1)[1].split("/")[0])


def shape_loopback(rtt, mbit):
    """For all that passes the loopback device, both directions together. False: the kernel refuses."""
    command = ["tc", "qdisc", "replace", "dev", "lo", "root", "netem", "limit", str(QUEUE),
               "delay", f"{rtt / 2}ms", "rate", f"{mbit}mbit"]
    return subprocess.run(command, capture_output=True).returncode == 0


def free_loopback():
    subprocess.run(["tc", "qdisc", "del", "dev", "lo", "root"], capture_output=True)


def enter_namespace():
    """Starts this program again in a network namespace of its own if netem works there."""
    if INSIDE in os.environ or not shutil.which("tc") or not shutil.which("unshare"):
        return
    script = "ip link set lo mtu 1500 up && tc qdisc add dev lo root netem delay 1ms && tc qdisc del dev lo root"
    prefix = ["unshare", "--net"] + ([] if os.geteuid() == 0 else ["--map-root-user"])
    if subprocess.run([*prefix, "sh", "-c", script], capture_output=True).returncode == 0:
        os.environ[INSIDE] = "1"
        inner = 'ip link set lo mtu 1500 up && exec "$@"'
        os.execvp(prefix[0], [*prefix, "sh", "-c", inner, "sh", sys.executable, *sys.argv])


def kind():
    if INSIDE in os.environ:
        return "tc netem on the loopback device of a network namespace"
    return "shaped_link.py, a relay of our own (the kernel does not allow netem here)"


@contextlib.contextmanager
def link_to(port, rtt, mbit):
    """The port at which the server of `port` is reached over the link; rtt None: without any."""
    if rtt is None:
        yield port
    elif INSIDE in os.environ:
        if not shape_loopback(rtt, mbit):
            sys.exit("tc: netem refuses the link")
        try:
            yield port
        finally:
            free_loopback()
    else:
        with Server(sys.executable, RELAY, "--to", port, "--rtt", rtt, "--mbit", mbit) as relay:
            yield port_of(relay.url)


def measured(rtt, mbit):
    """What link_probe finds of such a link."""
    octets = int(max(20_000, mbit * 1e6 / 8 * 0.1))  # a tenth of a second of the link
    with link_probe.ProbeServer() as server, link_to(server.port, rtt, mbit) as port:
        return link_probe.probe(port, octets)
