"""The messages between page and server, and their limits.

Both sides send JSON objects, one in each message of a websocket. The page sends these; ``id`` is a whole number that
comes back in the answer:

=========  ==========================================================================================================
kind       fields
=========  ==========================================================================================================
hello      ``session``: the name of the session that the page had before, or "". The first message.
load       ``loads``: loads by name, SI. ``gesture``: a whole number; loads of one gesture are undone together.
change     ``changes``: new values by the names of controls. ``follow``: "load" or "history". ``gesture`` as above.
nodes      ``nodes``: the number of nodes. ``follow`` as above.
undo       Back to the state before the last gesture.
redo       Forward again.
reset      No load, no history. It can be undone.
keep       ``on``: keep the present state as the reference, or forget the reference.
stop       End a long history that is being followed. It has no answer: the message that it ends is refused.
=========  ==========================================================================================================

The server answers each message with one of these:

=========  ==========================================================================================================
welcome    To hello. ``session``: the name of the session; ``version`` of fastpin.
pictures   The history of the page changes: ``drop`` pictures at its beginning go, the next ``keep`` stay, those behind
           them go, and the pictures ``add`` are appended. ``grids``: angles of the nodes by the name of a grid.
           ``undos``, ``redos``: gestures that can be undone and redone. ``case``: the problem and its controls, if they
           have changed. ``reference``: the reference, if it has changed. ``sentence``: a remark, or "".
refused    Input that can't be used. ``field`` and ``sentence`` say why. Nothing has changed.
lost       A load that nothing carries, or that the solver has lost. ``sentence`` says why, ``load`` where, ``fraction``
           which part of the step was carried. The contact is at the state before.
=========  ==========================================================================================================

Values are per thickness in SI units, as in Python. A unit of the page is an object with ``name`` and ``factor``: a
value times the factor is in this unit, in N with a thickness. If ``is_chosen``, the case chooses it: no prefix.
Controls and ``units`` of a case name their units so. Its ``prefixes`` are the choices of prefixes that do not depend on
the size of a value.

Arrays are little-endian float32 (the status: int8) in base64. Numbers outside arrays have all their digits. NaN is
null. A message that is no such message is answered by "refused".
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, choice, number, string, true_or_false, whole_number
from fastpin.model.grid import LEAST_NODES

MOST_BYTES = 16_384
"""Most bytes of a message from the page. The largest has nine loads; it is shorter than 1,000."""

MOST_WAITING = 64
"""Most messages of a connection that wait. A page sends one at a time."""

MOST_PICTURES = 2_000
"""Pictures of a history that are remembered: a minute of dragging, up to 20 MB with 200 nodes."""

MOST_OF_HOLES = 5_000
"""Pictures of single holes that a joint remembers: 500 steps of five pins in two plates, 45 MB."""

MOST_UNDONE = 200
"""Gestures that can be undone."""

MOST_UNDONE_NODES = 20_000
"""Nodes of all states for undo together: 100 gestures with 200 nodes, 12 with 1,600. A state takes 4 kB a node."""

MOST_NODES = 1_600
"""Nodes round the hole. A step with so many takes half a second."""

MOST_SESSIONS = 8
"""Contacts, each with its history: some 20 MB with 200 nodes."""


@dataclass(frozen=True)
class Message:
    """A message from the page: its kind, its number, and its fields."""

    kind: str
    id: int
    fields: dict[str, Any] = field(default_factory=dict)


def _table(name: str, value: object) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise InputError(name, f"must be an object with at least one entry, not {as_toml(value)}")
    return value


def _whole(name: str, value: object) -> int:
    return whole_number(name, value, 0, 2**53)  # beyond, JavaScript's numbers have gaps


def _follow(name: str, value: object) -> str:
    return choice(name, value, ("load", "history"))  # one straight step to the load, or all loads again


FIELDS: dict[str, dict[str, Any]] = {
    "hello": {"session": string},
    "load": {
        "loads": lambda name, value: {load: number(load, one) for load, one in _table(name, value).items()},
        "gesture": _whole,
    },
    "change": {"changes": _table, "follow": _follow, "gesture": _whole},
    "nodes": {
        "nodes": lambda name, value: whole_number(name, value, LEAST_NODES, MOST_NODES),
        "follow": _follow,
        "gesture": _whole,
    },
    "undo": {},
    "redo": {},
    "reset": {},
    "keep": {"on": true_or_false},
    "stop": {},
}
"""The fields of each kind of message, and their checks."""


def read_message(text: str) -> Message:
    """Read a message from the page.

    Raises
    ------
    InputError
        If the text is no message. The error names the field.
    """
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError("message", "is no JSON") from None
    if not isinstance(found, dict):
        raise InputError("message", f"must be an object, not {as_toml(found)}")
    kind = choice("kind", found.get("kind"), tuple(FIELDS))
    number_of_message = _whole("id", found.get("id"))
    unknown = found.keys() - FIELDS[kind].keys() - {"kind", "id"}
    if unknown:
        raise InputError("message", f"has an unknown field {as_toml(min(unknown))}")
    fields = {name: check(name, found.get(name)) for name, check in FIELDS[kind].items()}
    return Message(kind, number_of_message, fields)


def refusal(number_of_message: int | None, error: InputError) -> dict[str, Any]:
    """The answer to input that can't be used. The number is None where a message has none."""
    return {"kind": "refused", "id": number_of_message, "field": error.field, "sentence": str(error)}
