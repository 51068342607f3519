"""Templates of pages: what is given cannot become markup, and what is missing is a fault."""

import pytest
from jinja2 import UndefinedError

from common.templates import rendered


def test_what_is_given_is_escaped() -> None:
    given = {"words": "<b>&", "colour": '"><img src=x>', "facts": ["<img src=x>"]}
    html = rendered("animator.page", "status.html", given)
    assert "<b>&lt;b&gt;&amp;</b>" in html
    assert "<img" not in html


def test_a_name_that_is_not_given_is_a_fault() -> None:
    with pytest.raises(UndefinedError, match="colour"):
        rendered("animator.page", "status.html", {"words": "", "facts": []})
