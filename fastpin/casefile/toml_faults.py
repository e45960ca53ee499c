"""Sentences on the faults that the TOML parser finds, and the form of headers and keys."""

from __future__ import annotations

import re

from fastpin.model.checks import shortened

KEY = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY_LINE = re.compile(rf"\s*({KEY}(?:\s*\.\s*{KEY})*)\s*=(.*)")
HEADER = re.compile(rf"\s*(\[\[?)\s*({KEY}(?:\s*\.\s*{KEY})*)\s*\]")
STRING_OR_COMMENT = re.compile(
    r'''
    """ (?:\\.|.)*? (?:"""|\Z)
    | \'\'\' .*? (?:\'\'\'|\Z)
    | " (?:\\[^\n]|[^"\\\n])* "?
    | ' [^'\n]* '?
    | \# [^\n]*
    ''',
    re.DOTALL | re.VERBOSE,
)


def syntax_message(message: str, lines: list[str]) -> tuple[str, int]:
    """A sentence and a line for a message of the TOML parser."""
    last = max((number for number, line in enumerate(lines, start=1) if line.strip()), default=1)
    found = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", message)
    if not found:
        digits = next((n for n, line in enumerate(lines, start=1) if re.search(r"\d{4300}", line)), last)
        return "a number of thousands of digits can't be read", digits
    line = int(found[1]) if found[1] else last
    reason = message[: found.start()]
    if twice := re.match(r"Cannot declare \((.*?),?\) twice", reason):
        name = twice[1].replace("'", "").replace(", ", ".")
        return f"the section [{shortened(name)}] appears twice{_block_hint(name)}", line
    key = KEY_LINE.match(lines[line - 1])
    if reason.startswith("Cannot overwrite"):
        header = HEADER.match(lines[line - 1])
        name = header[2] if header else key[1] if key else ""
        return f'"{shortened(name)}" is given twice{_block_hint(name)}', line
    value = shortened(key[2].split("#")[0]) if key else ""
    label = shortened(key[1]) if key else ""
    if key and reason.startswith("Expected newline"):
        return f"{label}: {_behind_value(value)}", line
    if key and reason.startswith("Invalid value"):
        if not value:
            return f"{label}: its value is missing", line
        if re.fullmatch(r"[A-Za-z][A-Za-z0-9 .-]*", value):
            return f'{label}: text must stand in quotes, "{value}"', line
        if re.fullmatch(r"[+-]?\.\d.*", value):
            return f"{label}: a number needs a digit before its point, {value.replace('.', '0.', 1)}", line
        return f'{label}: must be a number, true, false, a [list] or "text in quotes"', line
    if reason.startswith("Expected '='"):
        return 'not of the form "key = value"', line
    return f"not TOML: {reason[0].lower()}{reason[1:]}", line


def _behind_value(value: str) -> str:
    """A sentence on a value with something behind it."""
    if re.fullmatch(r"[+-]?\d+,\d+([eE][+-]?\d+)?", value):
        return f"a number has a decimal point, {value.replace(',', '.')}"
    if re.fullmatch(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?\s*[A-Za-z%/^0-9]+", value):
        return f"must be a number without a unit, not {value}; SI units are meant, or those of the key units"
    return f"must be one value, not {value}"


def _block_hint(name: str) -> str:
    return "; several loads are [[load]] blocks, with double brackets" if name == "load" else ""
