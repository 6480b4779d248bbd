"""Files of strangers, made of good ones: cut, flipped, spliced, their numbers and words put in each other's place."""

import re
from collections.abc import Callable, Sequence
from xml.etree import ElementTree

import numpy as np

LARGEST = 1 << 21
"""Bytes of a case; growing is for bombs, not for patience."""
NUMBER = re.compile(rb"[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?")
STRANGE = tuple(
    word.encode()
    for word in (
        *("nan", "-nan", "inf", "-inf", "Infinity", "NaN", "1e308", "-1e308", "1e309", "1e-320", "-0", "0", "-1", "1"),
        *("1e9", "-1e9", "1e17", "9223372036854775807", "-9223372036854775809", "4294967296", "2147483648", "9" * 5000),
        *(
            "0." + "3" * 5000,
            "1_000",
            "0x10",
            "1,5",
            "1.5.5",
            "+",
            "1e",
            "١٢٣",
            "１２",
            "²",
            "½",
            "٣.٥",
            "",
            "''",
            "true",
        ),
    )
)
WORDS = tuple(
    word if isinstance(word, bytes) else word.encode()
    for word in (
        *(
            "\0",
            "\n",
            "\r",
            "\r\n\r\n",
            "\t",
            "\v",
            "\f",
            "\x1c",
            "\x1b[31m",
            "\x7f",
            "\x85",
            "\u2028",
            "\u202e",
            "\ufeff",
        ),
        *(
            b"\xff\xfe",
            b"\xfe\xff",
            b"\xed\xa0\x80",
            b"\xe4",
            b"\x80\x81",
            "é",
            "名",
            "🤖",
            "%s%n",
            "../../x",
            "/dev/zero",
        ),
        *('"', "'", '""', "#", ";", ",", ":", "=", "<", ">", "&", "{", "}", "[", "]", "\\", "|", "`", " " * 999),
        *("x" * 200, "x" * 200_000, "\u00e9" * 70_000, "[" * 100_000, "0 " * 50_000, "," * 100_000, "\n" * 100_000),
    )
)
Rng = np.random.Generator
Mutation = Callable[[bytes, Sequence[bytes], Sequence[bytes], Rng], bytes]


def pick(things: Sequence[bytes], rng: Rng) -> bytes:
    return things[int(rng.integers(len(things)))]


def span(content: bytes, rng: Rng) -> tuple[int, int]:
    """Somewhere in it: mostly short, sometimes long."""
    start = int(rng.integers(len(content) + 1))
    return start, min(len(content), start + int(2 ** rng.uniform(0, np.log2(len(content) + 2))))


def flipped(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    bits = np.frombuffer(content or b"\0", np.uint8).copy()
    for _ in range(int(rng.choice([1, 1, 2, 8, 64]))):
        bits[rng.integers(len(bits))] ^= 1 << int(rng.integers(8))
    return bits.tobytes()


def overwritten(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    start, end = span(content, rng)
    filling = rng.choice([0, 255, 32, 48, -1])
    fresh = rng.bytes(end - start) if filling < 0 else bytes([int(filling)]) * (end - start)
    return content[:start] + fresh + content[end:]


def cut(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    return content[: int(rng.integers(len(content) + 1))]


def deleted(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    start, end = span(content, rng)
    return content[:start] + content[end:]


def repeated(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    start, end = span(content, rng)
    times = min(int(rng.choice([1, 1, 3, 50, 3000])), LARGEST // (end - start + 1))
    return content[:end] + content[start:end] * times + content[end:]


def swapped(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    (a, b), (c, d) = sorted([span(content, rng), span(content, rng)])
    c, d = max(b, c), max(b, d)
    return content[:a] + content[c:d] + content[b:c] + content[a:b] + content[d:]


def spliced(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    other = pick(others, rng)
    return content[: span(content, rng)[0]] + other[span(other, rng)[0] :]


def inserted(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    start, end = span(content, rng)
    return (
        content[:start]
        + pick(words if words and rng.random() < 0.7 else WORDS, rng)
        + content[rng.choice([start, end]) :]
    )


def numbered(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    """Another number where one stands."""
    found = [*NUMBER.finditer(content)]
    if not found:
        return inserted(content, words, others, rng)
    for place in sorted(rng.integers(len(found), size=int(rng.choice([1, 1, 2, 5]))).tolist(), reverse=True):
        start, end = found[place].span()
        content = content[:start] + (pick(STRANGE, rng) if rng.random() < 0.8 else found[-1][0]) + content[end:]
    return content


def worded(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    """Another of the format's words where one stands."""
    there = [word for word in words if word and word in content]
    return content.replace(pick(there, rng), pick(words, rng), int(rng.choice([1, 9]))) if there else content


def relined(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    """Lines deleted, doubled, in another order, or with other ends."""
    lines = content.splitlines(keepends=True) or [b""]
    place, way = int(rng.integers(len(lines))), int(rng.integers(4))
    if way == 0:
        del lines[place]
    elif way == 1:
        lines.insert(place, pick(lines, rng))
    elif way == 2:
        rng.shuffle(lines)
    else:
        lines = [line.rstrip(b"\r\n") + pick([b"\r", b"\r\n", b"\n\n", b" \n", b""], rng) for line in lines]
    return b"".join(lines)


def remade(content: bytes, words: Sequence[bytes], others: Sequence[bytes], rng: Rng) -> bytes:
    """XML that stays well-formed: elements gone, doubled, elsewhere, deep in each other; attributes of other values."""
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError):
        return numbered(content, words, others, rng)
    inner = [(above, child) for above in root.iter() for child in above]
    parents = [above for above, _ in inner]
    above, child = inner[int(rng.integers(len(inner)))] if inner else (root, root)
    named, way = sorted(child.attrib), int(rng.integers(7))
    if way == 0 and inner:
        above.remove(child)
    elif way == 1 and inner:
        above.extend([child] * int(rng.choice([1, 1, 2, 500])))
    elif way == 2 and inner:
        above.remove(child)
        parents[int(rng.integers(len(parents)))].append(child)
    elif way == 3:
        inside = child
        for _ in range(int(rng.choice([1, 3, 600]))):
            inside = ElementTree.SubElement(inside, child.tag, child.attrib)
    elif named:
        name = named[int(rng.integers(len(named)))]
        fresh = pick(STRANGE if rng.random() < 0.8 else WORDS, rng).decode(errors="replace")
        kept = child.attrib[name].split() or [""]
        kept[int(rng.integers(len(kept)))] = "".join(c for c in fresh if c.isprintable())
        child.attrib[name] = " ".join(kept)
        if way == 4:
            del child.attrib[name]
    try:
        return ElementTree.tostring(root)
    except (RecursionError, ValueError):
        return content


MUTATIONS: tuple[Mutation, ...] = (
    *(flipped, overwritten, cut, deleted, repeated, swapped, spliced, inserted, inserted),
    *(numbered, numbered, numbered, worded, worded, relined),
)


def mutated(seeds: Sequence[bytes], words: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> bytes:
    """Case `number` of a reader. The seeds come first, whole; every eighth is one that ends early, all over it and ever
    more finely; all others are changed once to four times. `others` may be spliced in."""
    if number < len(seeds):
        return seeds[number]
    content = pick(seeds, rng)
    if number % 8 == 0:
        return content[: int(len(content) * (number // 8 * 0.6180339887 % 1))]
    ways = (*MUTATIONS, *(remade,) * 40) if content.lstrip()[:1] == b"<" else MUTATIONS
    for _ in range(int(rng.choice([1, 1, 1, 2, 4]))):
        content = ways[int(rng.integers(len(ways)))](content, words, [*seeds, *others], rng)[:LARGEST]
    return content
