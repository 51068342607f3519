"""What several commands take: their shared arguments and options."""

from pathlib import Path
from typing import Annotated, Final, Literal

import typer

Out = Annotated[Path, typer.Option(help="Folder to write into.")]
ModeName = Annotated[
    Literal["default", "paper"] | None, typer.Option(help="Instead of the settings' mode.")
]
OwnMode = Annotated[
    Literal["default", "paper"] | None,
    typer.Option(help="How clips are tracked, if not in the recogniser's own mode."),
]
CACHE: Final = Path("runs/tracked")
Cache = Annotated[
    Path, typer.Option(help="Keeps what tracking made of clips, 56 kB each; may be deleted.")
]
Size = Annotated[
    str | None, typer.Option(help="Bound of the working picture, instead of the settings'.")
]
