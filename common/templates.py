"""Pages from Jinja2 templates, in the folder `templates` of a package."""

from collections.abc import Mapping
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined


def rendered(package: str, name: str, given: Mapping[str, object]) -> str:
    """A template filled in: values are escaped, and a missing name is an error.

    Args:
        package: The package that holds the template, as imports name it.
        name: File name of the template.
        given: Values for the template's names.
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
