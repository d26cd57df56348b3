"""The numbers after the header of OctoMap's two formats, to bytes and back.

`engine` has it compiled.
Nodes come in the order parent, children 0 to 7. `.ot`: four bytes of log-odds, one with a bit for
each child that follows. `.bt`: two bytes for an inner node, two bits for each child: 0 unknown, 1 a
free leaf, 2 an occupied leaf, 3 an inner node that follows.
"""

from __future__ import annotations

import numpy as np

from backhoe.perception.octree.nodes import DEPTH, settle, take

WHOLE, TRUNCATED, TOO_DEEP, EMPTY_NODE, LEFT_OVER = range(5)
"""What `read_all` and `read_binary` find: how a file is corrupt, if it is."""


def write_all(value, child, odds, children):
    """The nodes of `.ot`, in order: their log-odds, and the bits of their children, both (n,)."""
    count, waiting = 0, [(0, 0)]
    while len(waiting) > 0:
        b, i = waiting.pop()
        below, bits = int(child[b, i]), 0
        for j in range(7, -1, -1):
            if below and not np.isnan(value[below, j]):
                bits |= 1 << j
                waiting.append((below, j))
        odds[count], children[count] = value[b, i], bits
        count += 1
    return count


def write_binary(value, child, words):
    """The words of `.bt`, (n,) of 16 bits; how many there are, what exceeds n is only counted."""
    count, waiting = 0, [(0, 0)]
    while len(waiting) > 0:
        b, i = waiting.pop()
        below, word = int(child[b, i]), 0
        for j in range(7, -1, -1):
            if child[below, j]:
                word |= 3 << 2 * j
                waiting.append((below, j))
            elif not np.isnan(value[below, j]):
                word |= (2 if value[below, j] >= 0 else 1) << 2 * j
        if count < len(words):
            words[count] = word
        count += 1
    return count


def read_all(value, child, books, odds, children):
    """Build the tree of `.ot` from what `write_all` gives; how the file is, and how many nodes."""
    count, waiting = 0, [(0, 0, 0)]
    while len(waiting) > 0:
        if count == len(odds):
            return TRUNCATED, count
        b, i, depth = waiting.pop()
        value[b, i], bits = odds[count], children[count]
        count += 1
        if bits == 0:
            continue
        if depth == DEPTH:
            return TOO_DEEP, count
        below = take(value, child, books)
        child[b, i] = below
        for j in range(7, -1, -1):
            if bits & 1 << j:
                waiting.append((int(below), j, depth + 1))
    return (WHOLE if count == len(odds) else LEFT_OVER), count


def read_binary(value, child, books, words, free, occupied):
    """Build the tree of `.bt` from its words, with log-odds for its two kinds of leaf.

    Returns:
        How the file is, and how many nodes it has.
    """
    count, nodes, waiting = 0, 1, [(0, 0, 0)]
    while len(waiting) > 0:
        if count == len(words):
            return TRUNCATED, nodes
        b, i, depth = waiting.pop()
        word = int(words[count])
        count += 1
        if word == 0:
            return EMPTY_NODE, nodes
        below = take(value, child, books)
        child[b, i] = below
        for j in range(7, -1, -1):
            kind = word >> 2 * j & 3
            nodes += kind > 0
            if kind == 3:
                if depth + 1 == DEPTH:
                    return TOO_DEEP, nodes
                waiting.append((int(below), j, depth + 1))
            elif kind:
                value[below, j] = free if kind == 1 else occupied
    return (WHOLE if count == len(words) else LEFT_OVER), nodes


def finish(value, child, blocks, prune):
    """Give the inner nodes of a tree whose blocks lie behind their parents' their largest value.

    Args:
        blocks: number of them.
        prune: whether to prune, too; `books` if so, else an empty array.
    """
    for b in range(blocks - 1, -1, -1):
        for i in range(8):
            if child[b, i]:
                largest = np.float32(-np.inf)
                for j in range(8):
                    if value[child[b, i], j] > largest:
                        largest = value[child[b, i], j]
                value[b, i] = largest
                if len(prune):
                    settle(value, child, prune, b, i)
