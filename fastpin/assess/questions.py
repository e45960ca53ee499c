"""The questions that a case asks of its result: for each a section beside the problem, and the file that answers it.

The file of a question has these names. What is found is an object of its own class.

* ``BAR``: text of the progress bar while it is looked for.
* ``FAILED``: what it means that nothing is found; the reason follows.
* ``MARGINS``: names of its margins of safety.
* ``OUTCOMES``: outcomes of sweeps by name, pairs of an :class:`fastpin.assess.outputs.Output` and a callable
  ``read(result, how)``, which gives the subject of the output for the value of the section.
* ``find(case, held, progress)``: what is found; None if it is not looked for. InputError says why nothing is found.
* ``judged(result, how)``: what margins need of a whole result in a sweep.
* ``lines(found, over)``: lines of text. `over` has the bodies that yield, see
  :func:`fastpin.states.margins.over_yield`.
* ``document(found, over)``: a dict for JSON, and ``schema()``, its JSON schema.
* ``margins(found)``: its margins of safety.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.solver.result import Result


class Questions(Mapping[str, Any]):
    """The files that answer, by the names of their sections. Each is imported when its question is asked first."""

    names = ("fatigue", "crack", "strength")

    def __getitem__(self, name: str) -> Any:
        if name not in self.names:
            raise KeyError(name)
        return importlib.import_module(f"fastpin.assess.{name}")

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


QUESTIONS = Questions()
"""The questions in the order of all texts."""


def of_question(name: str, quantity: str, how: Any, result: Result) -> float:
    """Return an outcome of a question; `how` is the value of its section.

    Raises
    ------
    FastpinError
        If the result can't be judged so.
    """
    output, read = QUESTIONS[name].OUTCOMES[quantity]
    value: float = output.number(read(result, how))
    return value
