"""What stands above docs/ as pages of the site, and words for files as links."""

import re
from pathlib import Path
from typing import Any, Final

from mkdocs.structure.files import File, Files

ABOVE: Final = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
NAMED: Final = re.compile(r"`docs/([a-z_]+)\.md`")


def on_files(files: Files, config: Any) -> Files:
    """Called by mkdocs, once it knows the pages of docs/."""
    root = Path(config["config_file_path"]).parent
    for name, page in ABOVE.items():
        text = (root / name).read_text().replace("](docs/", "](")
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Called by mkdocs with the text of each page."""
    for name, page in ABOVE.items():
        markdown = markdown.replace(f"](../{name})", f"]({page})").replace(
            f"]({name})", f"]({page})"
        )
    return NAMED.sub(r"[\1](\1.md)", markdown)
