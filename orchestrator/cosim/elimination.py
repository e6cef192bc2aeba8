"""In which order and with which blocks the linear system of a coupled step is eliminated.

What the ports of a rigid body take acts as one wrench at its first port, which is all the unknown that it has. The
wrenches on other bodies are unknown themselves; those of connections between the same bodies form a group. Groups that
share a body or a connection to a rigid body depend on each other. They are eliminated by least degree: a chain, and a
tree of chains, then stay as sparse as they were, so that memory and work grow linearly with the number of bodies. The
tables are read by fmus/native/coupling/blocks.h.

A body that never moves has no unknown: no wrench depends on those that it takes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import product
from typing import Any

import numpy as np

from .network import PortConnection

Indices = np.ndarray[Any, np.dtype[np.uintp]]


@dataclass(frozen=True, slots=True)
class Elimination:
    """Tables of indices (unsigned, size of a pointer).

    place (links,): first row, in the order of elimination, of each link's wrench or of its rigid body; 0 where it
    has none. begin (groups + 1,): first row of each group. blocks (n, 5): row group, column group, first column,
    columns, offset in the array of all values, `length` long. lower, upper: blocks by eliminated group, from
    `*_begin`; targets: the block that each product of both changes. parts (m, 2): offset and stride of the part of
    the matrix for every connection, port, port again, and port of the first port's body (of a rigid one: once),
    square with the size of a wrench; none for bodies that never move.
    """

    place: Indices
    begin: Indices
    blocks: Indices
    length: int
    lower_begin: Indices
    lower: Indices
    upper_begin: Indices
    upper: Indices
    targets: Indices
    parts: Indices


Range = tuple[int, int]


class _Pattern:
    """Groups, the neighbours of each, and the columns of a group that another depends on."""

    def __init__(self, meetings: list[PortConnection], width: int, still: Set[int], rigid: Set[int]) -> None:
        moving = [(link, m) for link, m in enumerate(meetings) if m.body not in still]
        bodies_of: dict[int, set[int]] = defaultdict(set)
        for _, meeting in moving:
            bodies_of[meeting.connection].add(meeting.body)
        members: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for link, m in moving:
            members[(-1, m.body) if m.body in rigid else tuple(sorted(bodies_of[m.connection]))].append(link)
        ranges: dict[int, dict[int, Range]] = defaultdict(dict)
        self.row: dict[int, Range] = {}
        self.sizes = [0] * len(members)
        for group, links in enumerate(members.values()):
            for position, link in enumerate(sorted(links, key=lambda i: (meetings[i].body, i))):
                body = meetings[link].body
                first = 0 if body in rigid else width * position
                span = (first, first + width)
                self.row[link] = (group, first)
                self.sizes[group] = span[1]
                ranges[body][group] = _hull(ranges[body].get(group, span), span)
        self.columns: dict[tuple[int, int], Range] = {}
        self.neighbours: list[set[int]] = [set() for _ in self.sizes]
        for groups in ranges.values():
            self._join_all(groups, groups)
        for bodies in bodies_of.values():
            for body, other in product(bodies & rigid, bodies):
                self._join_all(ranges[body], ranges[other])
                self._join_all(ranges[other], ranges[body])

    def _join_all(self, rows: dict[int, Range], columns: dict[int, Range]) -> None:
        for i in rows:
            for j, span in columns.items():
                if i != j:
                    self.join(i, j, span)

    def join(self, row: int, column: int, span: Range) -> None:
        """Let a group depend on columns of another."""
        key = (row, column)
        self.columns[key] = _hull(self.columns.get(key, span), span)
        self.neighbours[row].add(column)

    def eliminate(self) -> list[int]:
        """Fill in what elimination by least degree does, and return its order."""
        left = set(range(len(self.sizes)))
        queue = [(self._degree(group), group) for group in left]
        heapify(queue)
        order: list[int] = []
        while queue:
            degree, group = heappop(queue)
            if group not in left or degree != self._degree(group):
                continue
            left.discard(group)
            order.append(group)
            around = self.neighbours[group]
            for i in around:
                self.neighbours[i].discard(group)
            for i in around:
                for j in around - {i}:
                    self.join(i, j, self.columns[(group, j)])
                heappush(queue, (self._degree(i), i))
        return order

    def _degree(self, group: int) -> int:
        return sum(self.sizes[other] for other in self.neighbours[group])


def eliminate(
    meetings: list[PortConnection],
    width: int,
    still: Set[int] = frozenset(),
    rigid: Set[int] = frozenset(),
) -> Elimination:
    """Order and tables for the links of a network, in the order of its unknowns.

    width: numbers of a wrench; still: bodies that never move; rigid: bodies whose ports move as one, without those.
    """
    pattern = _Pattern(meetings, width, still, rigid)
    order = pattern.eliminate()
    rank = {group: position for position, group in enumerate(order)}
    begin = np.cumsum([0, *(pattern.sizes[group] for group in order)]).tolist()
    keys = [(group, group) for group in order] + list(pattern.columns)
    number = {key: position for position, key in enumerate(keys)}
    blocks, length = [], 0
    for row, column in keys:
        first, last = (0, pattern.sizes[row]) if row == column else pattern.columns[(row, column)]
        blocks.append((rank[row], rank[column], first, last - first, length))
        length += pattern.sizes[row] * (last - first)
    later = [sorted(pattern.neighbours[group], key=rank.__getitem__) for group in order]
    lower = [[number[(i, group)] for i in others] for group, others in zip(order, later, strict=True)]
    upper = [[number[(group, i)] for i in others] for group, others in zip(order, later, strict=True)]
    targets = [number[(i, j)] for others in later for i in others for j in others]

    def part(row: int, column: int) -> tuple[int, int]:
        (row_group, i), (column_group, j) = pattern.row[row], pattern.row[column]
        _, _, first, stride, offset = blocks[number[(row_group, column_group)]]
        return offset + i * stride + j - first, stride

    lists = [np.cumsum([0, *map(len, each)]) for each in (lower, upper)]
    return Elimination(
        _indices([_place(pattern, begin, rank, link) for link in range(len(meetings))]),
        _indices(begin),
        _indices(blocks),
        length,
        _indices(lists[0]),
        _indices([i for each in lower for i in each]),
        _indices(lists[1]),
        _indices([i for each in upper for i in each]),
        _indices(targets),
        _indices([part(row, column) for row, column in _pairs(meetings, still, rigid)]),
    )


def _place(pattern: _Pattern, begin: Sequence[int], rank: Mapping[int, int], link: int) -> int:
    if link not in pattern.row:
        return 0
    group, first = pattern.row[link]
    return begin[rank[group]] + first


def _pairs(meetings: list[PortConnection], still: Set[int], rigid: Set[int]) -> list[tuple[int, int]]:
    """Row and column links of the matrix, in the order in which connections are added to it."""
    of_body: dict[int, list[int]] = defaultdict(list)
    of_connection: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for link, meeting in enumerate(meetings):
        if meeting.body in still:
            continue
        of_connection[meeting.connection].append((meeting.connection_port, link))
        if not (meeting.body in rigid and of_body[meeting.body]):
            of_body[meeting.body].append(link)
    found = []
    for connection in sorted(of_connection):
        ports = [link for _, link in sorted(of_connection[connection])]
        for port in ports:
            found += [(row, column) for row in ports for column in of_body[meetings[port].body]]
    return found


def _hull(a: Range, b: Range) -> Range:
    return min(a[0], b[0]), max(a[1], b[1])


def _indices(values: Any) -> Indices:  # noqa: ANN401 - whatever NumPy takes
    return np.ascontiguousarray(values, dtype=np.uintp)
