"""Templates of pages: what is given cannot become markup, and what is missing is a fault."""

import pytest
from jinja2 import UndefinedError

from common.templates import rendered


def test_what_is_given_is_escaped() -> None:
    given = {"well": True, "text": "<b>& <img src=x>"}
    html = rendered("animator.retouching", "retouch_kept.html", given)
    assert "&lt;b&gt;&amp;" in html
    assert "<img" not in html


def test_a_name_that_is_not_given_is_a_fault() -> None:
    with pytest.raises(UndefinedError, match="text"):
        rendered("animator.retouching", "retouch_kept.html", {"well": True})
