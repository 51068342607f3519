"""Output of a command: JSON on stdout for programs, a line or a table for people."""

from collections.abc import Sequence
from typing import Annotated, Any

import msgspec
import typer
from rich.console import Console

from runtime.terminal import json_text

console = Console(stderr=True)
results = Console()

JsonWanted = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def tell(facts: dict[str, Any], json_wanted: bool, line: str) -> None:
    """A command's result: JSON on stdout, or a line for a person."""
    if json_wanted:
        print(json_text(facts))
    else:
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def tell_rows(rows: Sequence[msgspec.Struct], json_wanted: bool) -> None:
    """A command's result for each camera: JSON, or a table."""
    facts: list[dict[str, Any]] = [msgspec.to_builtins(row) for row in rows]
    if json_wanted:
        print(json_text(facts))
    else:
        from runtime.live.table import table_of_rows

        results.print(table_of_rows(facts))
