"""In which order and with which blocks the linear system of a coupled step is eliminated.

Connections between the same bodies form a group, and groups that share a body depend on each other. Groups
are eliminated by least degree: a chain, and a tree of chains, then stay as sparse as they were, so that
memory and work grow linearly with the number of bodies. The tables are read by fmus/native/coupling/blocks.h.

A body that never moves joins nothing: no wrench depends on those that it takes, so each of them is a group of its
own that is eliminated first.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Set
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from typing import Any

import numpy as np

from .network import PortConnection

Indices = np.ndarray[Any, np.dtype[np.uintp]]


@dataclass(frozen=True, slots=True)
class Elimination:
    """Tables of indices (unsigned, size of a pointer).

    place (links,): first row of each link's wrench in the order of elimination. begin (groups + 1,): first
    row of each group. blocks (n, 5): row group, column group, first column, columns, offset in the array of
    all values, `length` long. lower, upper: blocks by eliminated group, from `*_begin`; targets: the block
    that each product of both changes. parts (m, 2): offset and stride of the part of the matrix for
    every connection, port, port again, and port of the first port's body, square with the size of a wrench.
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

    def __init__(self, meetings: list[PortConnection], width: int, still: Set[int]) -> None:
        bodies_of: dict[int, set[int]] = defaultdict(set)
        for meeting in meetings:
            bodies_of[meeting.connection].add(meeting.body)
        members: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for link, meeting in enumerate(meetings):
            alone = (-1, link) if meeting.body in still else ()
            members[alone or tuple(sorted(bodies_of[meeting.connection] - still))].append(link)
        self.members = [sorted(links, key=lambda i: (meetings[i].body, i)) for links in members.values()]
        self.sizes = [width * len(links) for links in self.members]
        ranges: dict[int, dict[int, Range]] = defaultdict(dict)
        self.row: dict[int, Range] = {}
        for group, links in enumerate(self.members):
            for position, link in enumerate(links):
                span = (width * position, width * (position + 1))
                self.row[link] = (group, span[0])
                body = meetings[link].body
                ranges[body][group] = _hull(ranges[body].get(group, span), span)
        self.columns: dict[tuple[int, int], Range] = {}
        self.neighbours: list[set[int]] = [set() for _ in self.members]
        self.followers: dict[int, set[int]] = {}
        for group, links in enumerate(self.members):
            if meetings[links[0]].body in still:
                around = bodies_of[meetings[links[0]].connection] - still
                self._follow(group, [ranges[body] for body in around])
        for body, groups in ranges.items():
            if body not in still:
                self._join_all(groups)

    def _follow(self, group: int, around: list[dict[int, Range]]) -> None:
        """Let a group on a body that never moves depend on those around; none depends on it."""
        self.followers[group] = {other for groups in around for other in groups}
        for groups in around:
            for other, span in groups.items():
                key = (group, other)
                self.columns[key] = _hull(self.columns.get(key, span), span)

    def _join_all(self, groups: dict[int, Range]) -> None:
        for i in groups:
            for j, span in groups.items():
                if i != j:
                    self.join(i, j, span)

    def join(self, row: int, column: int, span: Range) -> None:
        """Let a group depend on columns of another."""
        key = (row, column)
        self.columns[key] = _hull(self.columns.get(key, span), span)
        self.neighbours[row].add(column)

    def eliminate(self) -> list[int]:
        """Fill in what elimination by least degree does, and return its order."""
        left = set(range(len(self.members))) - set(self.followers)
        queue = [(self._degree(group), group) for group in left]
        heapify(queue)
        order = list(self.followers)
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


def eliminate(meetings: list[PortConnection], width: int, still: Set[int] = frozenset()) -> Elimination:
    """Order and tables for the links of a network, in the order of its unknowns.

    width: numbers of a wrench; still: bodies that never move.
    """
    pattern = _Pattern(meetings, width, still)
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
    right = [
        sorted(pattern.followers.get(group, pattern.neighbours[group]), key=rank.__getitem__)
        for group in order
    ]
    lower = [[number[(i, group)] for i in others] for group, others in zip(order, later, strict=True)]
    upper = [[number[(group, i)] for i in others] for group, others in zip(order, right, strict=True)]
    targets = [number[(i, j)] for others in later for i in others for j in others]

    def part(row: int, column: int) -> tuple[int, int]:
        (row_group, i), (column_group, j) = pattern.row[row], pattern.row[column]
        _, _, first, stride, offset = blocks[number[(row_group, column_group)]]
        return offset + i * stride + j - first, stride

    lists = [np.cumsum([0, *map(len, each)]) for each in (lower, upper)]
    return Elimination(
        _indices([begin[rank[group]] + i for group, i in map(pattern.row.__getitem__, range(len(meetings)))]),
        _indices(begin),
        _indices(blocks),
        length,
        _indices(lists[0]),
        _indices([i for each in lower for i in each]),
        _indices(lists[1]),
        _indices([i for each in upper for i in each]),
        _indices(targets),
        _indices([part(row, column) for row, column in _pairs(meetings, still)]),
    )


def _pairs(meetings: list[PortConnection], still: Set[int]) -> list[tuple[int, int]]:
    """Row and column links of the matrix, in the order in which connections are added to it."""
    of_body: dict[int, list[int]] = defaultdict(list)
    of_connection: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for link, meeting in enumerate(meetings):
        if meeting.body not in still:
            of_body[meeting.body].append(link)
        of_connection[meeting.connection].append((meeting.connection_port, link))
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
