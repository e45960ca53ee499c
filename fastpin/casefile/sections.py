"""Tables inside of sections of a case file."""

from __future__ import annotations

from typing import Any

from fastpin.casefile.toml_text import CaseText, Section


class Inside(Section):
    """The table of a key of a section. The section reports its faults."""

    def __init__(self, source: CaseText, section: Section, key: str, table: dict[str, Any]) -> None:
        super().__init__(source, (section.name, key), table)
        self._section, self._key = section, key

    def report(self, message: str, *key: str) -> None:
        """Add a fault of a key, or of the whole table if no key is given."""
        self._section.report(message, self._key, *key)
