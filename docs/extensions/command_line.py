"""The commands of fastpin and their options as Markdown, from the parser itself."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator

from fastpin.cli.options import EXIT_CODES, parser

WIDE = 84
"""Columns of a usage line; wider lines are cut by narrow windows."""


def command_line() -> str:
    """A section for each command: usage, arguments, options."""
    root = parser()
    (commands,) = (action for action in root._actions if isinstance(action, argparse._SubParsersAction))
    texts = {choice.dest: choice.help or "" for choice in commands._choices_actions}
    parts = [f"{EXIT_CODES}\n"]
    for name, command in commands.choices.items():
        parts.append("\n".join(_section(name, texts[name], command)))
    return "\n".join(parts)


def _section(name: str, text: str, command: argparse.ArgumentParser) -> Iterator[str]:
    command.formatter_class = lambda prog: argparse.HelpFormatter(prog, width=WIDE)
    usage = command.format_usage().removeprefix("usage: ").rstrip()
    yield from (f"## fastpin {name}", "", f"{text[:1].upper()}{text[1:]}.", "", "```text", usage, "```", "")
    actions = [action for action in command._actions if action.help != argparse.SUPPRESS and action.dest != "help"]
    for action in actions:
        yield from (_names(action), f": {_help(action, command)}", "")


def _names(action: argparse.Action) -> str:
    """The argument, or the option with its value, such as ``--nodes N``."""
    value = action.metavar if isinstance(action.metavar, str) else action.dest
    if not action.option_strings:
        return f"`{value}`"
    if action.nargs == 0:
        return ", ".join(f"`{option}`" for option in action.option_strings)
    if action.choices is not None and action.metavar is None:
        value = "{" + ",".join(map(str, action.choices)) + "}"
    value = f"[{value}]" if action.nargs == "?" else value
    return ", ".join(f"`{option} {value}`" for option in action.option_strings)


def _help(action: argparse.Action, command: argparse.ArgumentParser) -> str:
    """The help of an option, with its default filled in."""
    text = (action.help or "").replace("%(prog)s", command.prog)
    text = text % {**vars(action), "prog": command.prog} if "%" in text else text
    text = re.sub(r"(?<![\w`])--?[a-z][\w-]*", r"`\g<0>`", " ".join(text.split()))
    return text.replace("*", "\\*").replace("<", "\\<") or "no more words are needed"
