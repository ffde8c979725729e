"""Clients of the soak: threads that ask, check what comes and count it."""
import collections
import contextlib
import random
import threading

from soak_client import Closed, Connection, WrongHttp, request
from soak_hostile import hostile, idle_storm
from soak_requests import Wrong, invalid, repeated, valid

MOST_FAULTS_TOLD = 20


class Counts:
    """What all workers did together. Thread-safe."""

    def __init__(self):
        self.lock = threading.Lock()
        self.requests, self.hostile = collections.Counter(), collections.Counter()
        self.faults, self.wrong, self.reconnected = [], 0, 0

    def done(self, kind):
        with self.lock:
            self.requests[kind] += 1

    def attacked(self, kind, status):
        with self.lock:
            self.hostile[kind, status or "closed"] += 1

    def fault(self, text):
        with self.lock:
            self.wrong += 1
            if len(self.faults) < MOST_FAULTS_TOLD:
                self.faults.append(text)


class Asker:
    """One client with a connection to each server that it keeps, mostly."""

    def __init__(self, counts, ports, chance):
        self.counts, self.chance, self.kept = counts, chance, dict.fromkeys(ports)

    def exchange(self, port, ask):
        if self.kept[port] is None:
            self.kept[port] = Connection(port)
        connection = self.kept[port]
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # refused before its end was sent
            connection.send(request(ask.method, ask.target, ask.fields, ask.content))
        answer = connection.read(ask.method != "HEAD")
        if answer.fields.get("connection", "").lower() == "close" or self.chance.random() < 0.02:
            self.drop(port)
        return answer

    def drop(self, port):
        if self.kept[port] is not None:
            self.kept[port].close()
            self.kept[port] = None

    def ask(self, port, ask):
        """The right answer, or None."""
        try:
            fresh = self.kept[port] is None
            try:
                answer = self.exchange(port, ask)
            except Closed:  # a connection may be closed while nothing is asked
                self.drop(port)
                if fresh:
                    raise
                self.counts.reconnected += 1
                answer = self.exchange(port, ask)
            ask.check(answer)
            self.counts.done(ask.kind)
            return answer
        except (Wrong, WrongHttp, Closed, OSError, ValueError, KeyError) as problem:
            self.drop(port)
            self.counts.fault(f"port {port}, {ask}: {problem!r}")
            return None

    def close(self):
        for port in self.kept:
            self.drop(port)


class Workers:
    """Threads that ask until they are ended, each by a generator of its own."""

    def __init__(self, counts, meshes, ports, seed, storm):
        self.counts, self.meshes, self.ports, self.storm = counts, meshes, ports, storm
        self.ending = threading.Event()
        kinds = (self.ask_valid, self.ask_valid, self.ask_invalid, self.attack, self.attack, self.attack, self.idle)
        self.threads = [threading.Thread(target=self.run, args=(kind, random.Random(f"{seed} {number}")))
                        for number, kind in enumerate(kinds)]

    def run(self, kind, chance):
        asker = Asker(self.counts, self.ports, chance)
        while not self.ending.is_set():
            kind(asker, chance.choice(self.meshes), chance.choice(self.ports), chance)
        asker.close()

    def ask_valid(self, asker, mesh, port, chance):
        ask = valid(mesh, chance)
        answer = asker.ask(port, ask)
        if answer and chance.random() < 0.2:
            asker.ask(port, repeated(ask, answer.fields["etag"], chance))

    def ask_invalid(self, asker, mesh, port, chance):
        asker.ask(port, invalid(mesh, chance))

    def attack(self, asker, mesh, port, chance):
        try:
            self.counts.attacked(*hostile(mesh, port, chance))
        except Wrong as problem:
            self.counts.fault(f"port {port}, {problem}")

    def idle(self, asker, mesh, port, chance):
        try:
            idle_storm(port, chance, self.storm, min(3, self.storm / 500))
            self.counts.attacked("idle connections", self.storm)
        except OSError as problem:
            self.counts.fault(f"port {port}, idle connections: {problem!r}")
        self.ending.wait(1)

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self.ending.set()
        for thread in self.threads:
            thread.join()
