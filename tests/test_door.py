"""Who may come in: this machine's own browser tab, and no other page or name."""

import pytest

from animator.page.door import (
    Entrance,
    PageError,
    address_of,
    entrance_of,
    invitation_of,
    is_own,
    refuse_port,
)
from common.config.part_settings import PageSettings


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


@pytest.mark.parametrize("host", ["[::1", "[evil]:80", "a[b", "rig.example:80:80@"])
def test_a_name_that_is_none_is_refused(host: str) -> None:
    assert not is_own(host, "")
    assert not is_own("127.0.0.1:8080", f"http://{host}")


def test_a_proxy_is_let_in_by_its_name_and_by_its_own_page_alone() -> None:
    proxied = Entrance(name="rig.example")
    assert is_own("rig.example", "https://rig.example", proxied)
    assert not is_own("rig.example", "https://evil.example", proxied)
    assert not is_own("evil.example", "https://evil.example", proxied)
    assert is_own("127.0.0.1:8080", "http://127.0.0.1:8080", proxied)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1"])
def test_no_token_is_asked_for_where_no_other_machine_gets_to(host: str) -> None:
    assert entrance_of(PageSettings(host=host)).token == ""


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5", "rig.local"])
def test_each_page_beyond_this_machine_has_a_token_of_its_own(host: str) -> None:
    """RFC 4648: 32 random bytes are 43 letters."""
    one, other = entrance_of(PageSettings(host=host)), entrance_of(PageSettings(host=host))
    assert one.token != other.token
    assert len(one.token) >= 43
    assert invitation_of(one, 8080).endswith(f":8080/?token={one.token}")
    assert one.token not in address_of(one, 8080)


def test_an_address_of_six_is_written_in_brackets() -> None:
    assert address_of(Entrance("fe80::1"), 8080) == "http://[fe80::1]:8080"


def test_a_host_that_is_not_this_machines_is_named() -> None:
    with pytest.raises(PageError, match=r"port 8080 of 192\.0\.2\.1: cannot assign"):
        refuse_port(8080, "192.0.2.1")


def test_port_zero_means_no_page() -> None:
    with pytest.raises(PageError, match=r"page\.port is 0"):
        refuse_port(0)
