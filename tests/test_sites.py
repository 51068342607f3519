"""The file of sites, held against what a person may write in it."""

import threading
from pathlib import Path

import pytest

from common.config.part_settings import SettingsError
from runtime.serving.serve import SitesWatch
from runtime.serving.sites import files_of, load_sites

INLINE = """
[[site]]
name = "{name}"
[site.settings]
clip = "clips/walk"
{more}
[site.settings.page]
port = {page}
[site.settings.bus]
endpoint = "{endpoint}"
"""


def site(name: str, page: int = 0, endpoint: str = "auto", more: str = "") -> str:
    return INLINE.format(name=name, page=page, endpoint=endpoint, more=more)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "sites.toml"
    path.write_text(text)
    return path


def refused(tmp_path: Path, text: str) -> str:
    with pytest.raises(SettingsError) as caught:
        load_sites(written(tmp_path, text))
    assert "\n" not in str(caught.value)
    assert "sites.toml" in str(caught.value)
    return str(caught.value)


def test_a_site_is_a_settings_file_or_the_settings_themselves(tmp_path: Path) -> None:
    (tmp_path / "rooms").mkdir()
    (tmp_path / "rooms/hall.toml").write_text("clip = 'walk'\nroom = 'big'\n[page]\nport = 0")
    entry = "[[site]]\nname = 'hall'\nsettings = 'rooms/hall.toml'\nout = 'elsewhere'\n"
    found = load_sites(written(tmp_path, entry + site("lobby")))
    hall, lobby = found.sites["hall"], found.sites["lobby"]
    assert hall.settings.clip == str(tmp_path / "rooms/walk"), "relative to its own file"
    assert (hall.settings.room, hall.out) == ("big", tmp_path / "elsewhere")
    assert lobby.settings.clip == str(tmp_path / "clips/walk"), "relative to the file of sites"
    assert (lobby.settings.room, lobby.out) == ("lobby", tmp_path / "runs/lobby")
    assert files_of(tmp_path / "sites.toml") == (
        tmp_path / "sites.toml",
        tmp_path / "rooms/hall.toml",
    )


def test_environment_variables_are_filled_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "rooms").mkdir()
    (tmp_path / "rooms/walk.toml").write_text('clip = "$ROOMS/walk"')
    monkeypatch.setenv("ROOMS", str(tmp_path / "rooms"))
    path = written(
        tmp_path, '[[site]]\nname = "a"\nsettings = "$ROOMS/walk.toml"\nout = "$ROOMS/out"'
    )
    found = load_sites(path).sites["a"]
    assert found.settings.clip == str(tmp_path / "rooms/walk")
    assert found.out == tmp_path / "rooms/out"
    assert files_of(path) == (path, tmp_path / "rooms/walk.toml")
    monkeypatch.delenv("ROOMS")
    assert "$ROOMS/walk.toml names a variable that is not set" in refused(
        tmp_path, path.read_text()
    )


def test_a_site_says_whether_its_parts_are_one_process(tmp_path: Path) -> None:
    together = site("hall").replace("[site.settings]", "together = true\n[site.settings]")
    found = load_sites(written(tmp_path, site("lobby") + together))
    assert [each.together for each in found.sites.values()] == [False, True]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "names no site: write [[site]]"),
        ("[[site]]\nname = 'hall'", "site 1, settings is missing"),
        ("sites = 3", "unknown setting sites (did you mean site?)"),
        ("[[site]]\nname = 'a/b'\nsettings = 'x.toml'", "plain word, got 'a/b'"),
        ("[[site]]\nname = '..'\nsettings = 'x.toml'", "plain word, got '..'"),
        ("[[site]]\nname = 'hall'\nsettings = 'x.toml'", "site hall: there is no clip folder"),
        (
            site("hall", more="rooom = 'x'"),
            "unknown setting site 1, settings.rooom (did you mean room?)",
        ),
        (site("hall") + site("hall"), "2 sites have the name hall (hall, hall)"),
        (site("hall") + site("lobby") + site("hall"), ": 2 sites have the name hall (hall, hall)"),
        ("metrics = '9464'\n" + site("hall"), "look like 127.0.0.1:9464"),
    ],
)
def test_what_no_service_could_mean_is_refused_with_its_place(
    tmp_path: Path, text: str, word: str
) -> None:
    assert word in refused(tmp_path, text)


def test_two_sites_in_one_folder_are_refused(tmp_path: Path) -> None:
    def with_out(name: str, out: str) -> str:
        return site(name).replace("[site.settings]", f"out = '{out}'\n[site.settings]", 1)

    said = refused(tmp_path, with_out("hall", "runs/one") + with_out("lobby", "./runs/../runs/one"))
    assert "2 sites have the folder" in said
    assert "(hall, lobby)" in said


@pytest.mark.parametrize(
    "text",
    [
        site("hall", endpoint="tcp/127.0.0.1:7447") + site("lobby", endpoint="tcp/localhost:7447"),
        site("hall", page=7447) + site("lobby", endpoint="tcp/127.0.0.1:7447"),
        site("hall", page=7447, endpoint="tcp/127.0.0.1:7447") + site("lobby"),
        site("hall", more="metrics = '127.0.0.1:7447'") + site("lobby", page=7447),
        "metrics = '127.0.0.1:7447'\n" + site("hall", page=7447),
    ],
    ids=["two buses", "page and bus", "one site", "metrics and page", "the service's own"],
)
def test_what_would_listen_twice_on_a_port_is_refused_before_anything_starts(
    tmp_path: Path, text: str
) -> None:
    said = refused(tmp_path, text)
    assert "port 7447 (" in said
    assert "endpoint = 'auto'" in said


def test_the_sites_that_are_shipped_load() -> None:
    found = load_sites(Path(__file__).parents[1] / "configs" / "sites.toml")
    assert list(found.sites) == ["hall", "lobby"]


def test_endpoints_that_are_left_open_never_clash(tmp_path: Path) -> None:
    assert len(load_sites(written(tmp_path, site("hall") + site("lobby"))).sites) == 2


def test_what_is_no_text_or_is_not_there_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "sites.toml"
    with pytest.raises(SettingsError, match="cannot read the sites"):
        load_sites(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SettingsError, match=r"sites\.toml"):
        load_sites(path)


def test_a_settings_file_that_was_refused_is_read_again_when_it_is_mended(tmp_path: Path) -> None:
    path = written(tmp_path, site("lobby"))
    watch = SitesWatch(path)
    (tmp_path / "hall.toml").write_text("clip = 'walk'\nsise = '160x120'\n")
    written(tmp_path, site("lobby") + "[[site]]\nname = 'hall'\nsettings = 'hall.toml'\n")
    asked = threading.Event()
    assert watch.changed(10.0, asked)
    assert "sise" in watch.read()
    assert not watch.changed(20.0, asked)
    (tmp_path / "hall.toml").write_text("clip = 'walk'\n[page]\nport = 0\n")
    assert watch.changed(30.0, asked)
    assert watch.read() == ""
    assert [*watch.sites.sites] == ["lobby", "hall"]
