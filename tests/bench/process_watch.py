"""What a process holds, from /proc: memory, threads, descriptors."""
import os
import re


def memory(pid):
    """Resident octets."""
    with open(f"/proc/{pid}/status", encoding="ascii", errors="replace") as file:
        return int(re.search(r"^VmRSS:\s+(\d+) kB", file.read(), re.MULTILINE).group(1)) * 1024


def threads(pid):
    return len(os.listdir(f"/proc/{pid}/task"))


def descriptors(pid):
    """(sockets, others)"""
    sockets = others = 0
    for entry in os.listdir(f"/proc/{pid}/fd"):
        try:
            is_socket = os.readlink(f"/proc/{pid}/fd/{entry}").startswith("socket:")
        except FileNotFoundError:  # closed meanwhile
            continue
        sockets, others = sockets + is_socket, others + (not is_socket)
    return sockets, others
