"""What the network of landmarks is taught with: its layers, its pictures, its loss, its file."""

from pathlib import Path


def work_of(out: Path) -> Path:
    """The folder of what is drawn and learnt for a network, from which its training goes on."""
    return out.with_name(out.name + ".work")
