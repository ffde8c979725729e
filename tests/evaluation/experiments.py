"""The experiments: what each shows, and what is run for it."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Topic:
    """A section of the page."""

    title: str
    question: str


TOPICS = {
    1: Topic("Sender's CPU by part", "What does a receiver that decides for itself save the sender?"),
    2: Topic("Bytes up and down", "What does a record cost on the wire, and what its ID?"),
    3: Topic("PSNR against received bytes", "How soon is the picture good, each way?"),
    4: Topic("Error pixels", "What is wrong with the picture when only visible vertices were split?"),
    5: Topic("Quality of the order", "How far is the ranking from the best order there is?"),
    6: Topic("Memory and bytes along a path", "What does a session cost the sender while the receiver moves?"),
    7: Topic("IDs, bits by field, splits a second", "What do balanced trees buy, and what is in a record?"),
    8: Topic("Caching", "What does the origin still send when many receivers look at one mesh?"),
    9: Topic("Round trip and bandwidth", "How long does a person wait, each way, over which link?"),
}


@dataclasses.dataclass(frozen=True)
class Experiment:
    """`name` is that of the folder with what it writes. `command` begins with a program of build/bin or
    with a script of this folder (NAME.py); --output DIR, --short and what `takes` names follow."""

    name: str
    numbers: tuple
    command: tuple
    takes: tuple = ()  # of: bin (--bin FOLDER), results (--results DIR), meshes (paths), packs (--mesh NAME=PACK)
    meshes: tuple = ()  # names; in the short form bunny alone
    minutes: float = 5  # is ended after twice so many
    programs: tuple = ()  # built for it, beside those of meshfront
    folders: tuple = ()  # that it writes beside its own


EXPERIMENTS = (
    Experiment("sender", (1, 2, 6), ("sender.py",), ("bin", "meshes"), ("bunny", "igea"), 8,
               ("evaluate-sender", "sender-driven-server", "sender-driven-client")),
    Experiment("quality_against_bytes", (3, 4, 5), ("evaluate-quality",), ("packs",), ("bunny", "horse", "igea", "gcanyon600"),
               10, ("evaluate-quality",), ("visible_only", "order_quality")),
    Experiment("tables", (7,), ("tables.py",), ("bin", "meshes"), ("bunny", "horse", "igea", "gcanyon600"), 4),
    Experiment("caching", (8,), ("caching.py",), ("bin", "meshes"), ("bunny", "igea"), 8),
    Experiment("network", (9,), ("network.py",), ("bin", "results", "meshes"), ("bunny", "igea"), 10, ("write-plain-ply",)),
)
