"""Command lines, held against the commands that there are."""

import typer

from tritrack.__main__ import app


def words_of(command: str) -> list[str]:
    """Of what a page types, without its remark and what it is piped into."""
    return command.split("#", maxsplit=1)[0].split("|", maxsplit=1)[0].split()


def unknown_in(words: list[str]) -> list[str]:
    """Words behind `tritrack` that mean nothing: no command, or none of its options."""
    command, rest = typer.main.get_command(app), list(words)
    while rest and rest[0] in getattr(command, "commands", {}):
        command = command.commands[rest.pop(0)]  # type: ignore[attr-defined]
    if hasattr(command, "commands"):
        return rest[:1] or ["no command"]
    known = {each for param in command.params for each in [*param.opts, *param.secondary_opts]}
    given = {word.split("=")[0] for word in rest if word.startswith("--")}
    return sorted(given - known - {"--help"})
