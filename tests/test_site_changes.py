"""What is to be done that running sites become wanted ones: laws, for any two sets of sites."""

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from common.config.settings import Settings
from runtime.serving.site_changes import changes
from runtime.serving.sites import Site

NAMES = st.sampled_from(["hall", "lobby", "annex", "stage"])
SETTINGS = st.builds(Settings, every=st.integers(1, 3))


@st.composite
def some_sites(draw: st.DrawFn) -> dict[str, Site]:
    chosen = draw(st.dictionaries(NAMES, SETTINGS))
    return {name: Site(name, settings, Path("runs", name)) for name, settings in chosen.items()}


@given(some_sites(), some_sites())
def test_what_is_left_and_what_is_started_is_what_is_wanted(
    wanted: dict[str, Site], running: dict[str, Site]
) -> None:
    stop, start = changes(wanted, running)
    left = {name: site for name, site in running.items() if name not in stop}
    assert not left.keys() & {site.name for site in start}, "nothing runs twice"
    assert {**left, **{site.name: site for site in start}} == wanted


@given(some_sites(), some_sites())
def test_a_site_that_is_as_it_shall_be_is_left_alone(
    wanted: dict[str, Site], running: dict[str, Site]
) -> None:
    stop, start = changes(wanted, running)
    same = {name for name in wanted if running.get(name) == wanted[name]}
    assert not same & {*stop, *(site.name for site in start)}


@given(some_sites())
def test_nothing_is_done_twice(sites: dict[str, Site]) -> None:
    assert changes(sites, sites) == ((), ())
