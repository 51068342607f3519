"""Pages written as Jinja2 templates, which lie in the folder `templates` of a package."""

from collections.abc import Mapping
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined


def rendered(package: str, name: str, given: Mapping[str, object]) -> str:
    """A template filled in: what is given is escaped, and a name that is not given is a fault.

    Args:
        package: Where the template lies, as imports name it.
        name: Of its file.
        given: What the template names.
    """
    return _environment(package).get_template(name).render(given)


@cache
def _environment(package: str) -> Environment:
    return Environment(
        loader=PackageLoader(package),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
