"""Ports of a component, and other variables that belong together, as terminals of FMI 3.0."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from lxml.etree import Element, SubElement

from components import Component, Port, port_layout
from components.contract.ports import Terminal, TerminalMember

from .xml import VENDOR, xml_bytes

_FLOWS: Mapping[str, Literal["inflow", "outflow"]] = {"body": "inflow", "connection": "outflow"}
"""What force and torque of a terminal are: they flow from the connection into the body."""


def terminals_of(component: Component) -> tuple[Terminal, ...]:
    """Every port as a terminal, and those that the component declares besides.

    Members have the same names on both sides of a joint.
    """
    return (*(_of_port(port) for port in component.ports), *component.terminals)


def _of_port(port: Port) -> Terminal:
    inputs, outputs = port_layout(port)
    motion, wrench = (outputs, inputs) if port.side == "body" else (inputs, outputs)
    flow, prefix = _FLOWS[port.side], f"{port.name}."
    members = (
        *(TerminalMember(q.name.removeprefix(prefix), q.name) for q in motion),
        *(TerminalMember(q.name.removeprefix(prefix), q.name, flow) for q in wrench),
    )
    description = f"Mechanical port {port.name}, side of a {port.side}"
    return Terminal(port.name, "mechanical-port", description, members)


def terminals_xml(component: Component) -> bytes:
    """terminalsAndIcons.xml."""
    root = Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    parent = SubElement(root, "Terminals")
    for terminal in terminals_of(component):
        attributes = {
            "name": terminal.name,
            "matchingRule": terminal.rule,
            "terminalKind": f"{VENDOR}.{terminal.kind}",
            "description": terminal.description,
        }
        element = SubElement(parent, "Terminal", attributes)
        for member in terminal.members:
            said = {"variableName": member.variable, "memberName": member.name, "variableKind": member.kind}
            SubElement(element, "TerminalMemberVariable", said)
    return xml_bytes(root)
