"""Who may come in: this machine's own browser tab, and no other page or name."""

import pytest

from animator.page.door import PageError, is_own, refuse_port


@pytest.mark.parametrize(
    ("host", "origin", "own"),
    [
        ("127.0.0.1:8080", "http://127.0.0.1:8080", True),
        ("localhost:9000", "http://localhost:9000", True),
        ("127.0.0.1:8080", "", True),
        ("127.0.0.1:8080", "https://evil.example", False),
        ("127.0.0.1:8080", "null", False),
        ("127.0.0.1:8080", "http://127.0.0.1:3000", False),
        ("evil.example:8080", "http://evil.example:8080", False),
        ("127.0.0.1.evil.example", "", False),
        ("", "", False),
    ],
)
def test_only_the_pages_own_browser_tab_may_connect(host: str, origin: str, own: bool) -> None:
    """Neither another web page nor a foreign name that points here (DNS rebinding)."""
    assert is_own(host, origin) is own


def test_port_zero_means_no_page() -> None:
    with pytest.raises(PageError, match=r"page\.port is 0"):
        refuse_port(0)
