"""Files of cameras to look from, as meshfront-load --views takes them."""

import random


def write_views(path, count, seed=1):
    """Different views: some of the whole, some close, from everywhere."""
    chance = random.Random(seed)
    with path.open("w") as out:
        for _ in range(count):
            zoom = chance.choice((1, 2, 4))
            print(f"zoom={zoom};azimuth={chance.uniform(0, 360):.2f};elevation={chance.uniform(-20, 60):.2f}", file=out)
