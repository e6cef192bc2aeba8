"""Resources of a native FMU, damaged in every way that a random generator finds."""

import random
from pathlib import Path


def damaged_folders(resources, folder, count, seed):
    """Folders beneath one, each with resources of one kind of damage."""
    content, generator = Path(resources, "component.bin").read_bytes(), random.Random(seed)
    folders = [folder / f"damaged{k}" for k in range(count)]
    for place in folders:
        place.mkdir()
        (place / "component.bin").write_bytes(_damaged(content, generator))
    return folders


def _damaged(content, generator):
    """The bytes with one kind of damage."""
    place = generator.randrange(len(content))
    kind = generator.randrange(4)
    if kind == 0:
        return content[:place]
    if kind == 1:
        return content[:place] + content[max(0, place - generator.randrange(64)) :]
    changed = bytearray(content)
    if kind == 2:
        for _ in range(generator.randrange(1, 20)):
            changed[generator.randrange(len(content))] = generator.randrange(256)
        return bytes(changed)
    numbers = (
        b"\0" * 8,
        b"\xff" * 8,
        bytes(6) + b"\xf0\x7f",
        bytes(6) + b"\xf8\x7f",
        b"\xff" * 6 + b"\xef\x7f",
    )
    changed[place : place + 8] = generator.choice(numbers)
    return bytes(changed[: len(content)])
