"""What msgspec refuses, said in words that a file's writer knows: thing, place and cure."""

import msgspec
import pytest

from calibration.paper.markers import Markers
from common.config.explained import explained
from common.config.settings import Settings
from common.notes.notes import Notes
from common.rig.camera import Rig
from runtime.serving.sites import SitesFile

MARKERS = "width = 3\nheight = 4\n[[cameras]]\nname = 'a'\n"


@pytest.mark.parametrize(
    ("kind", "text", "said"),
    [
        (Settings, "clipp = 'x'", "unknown setting clipp (did you mean clip?)"),
        (Settings, "[search]\nstop = 4", "unknown setting search.stop (did you mean stop_deg?)"),
        (
            Settings,
            "[search]\nxyz = 4",
            "unknown setting search.xyz (known are arm_window_deg, leg_window_deg, stop_deg)",
        ),
        (Settings, "mode = 'dflt'", "mode must be default, paper or thesis, got 'dflt'"),
        (Settings, "every = 'two'", "every must be a whole number, got text"),
        (Settings, "[page]\nport = 1.5", "page.port must be a whole number, got a fraction"),
        (Settings, "[page]\nwait = 1", "page.wait must be true or false, got a whole number"),
        (Settings, "cameras = 3", "cameras must be a table, got a whole number"),
        (Settings, "every = 0", "every must be from 1 to 1000, got 0"),
        (Settings, "[page]\nport = -1", "page: port must be from 0 to 65535, got -1"),
        (
            Settings,
            "room = ",
            "at the end of the file: a value is missing: write a number, true, false, or a text in "
            "quotes",
        ),
        (SitesFile, "[[site]]\nname = 'a'", "site 1, settings is missing: add it"),
        (
            SitesFile,
            "[[site]]\nname = 'a'\n[site.settings.page]\nprt = 1",
            "unknown setting site 1, settings.page.prt (did you mean port?)",
        ),
        (Markers, "width = 3", "height is missing: add it"),
        (Markers, "width = 0", "width must be a whole number >= 1"),
        (
            Markers,
            f"{MARKERS}focal_px = 2\nfloor_px = [[1, 2], [3]]",
            "cameras 1, floor_px 2 must have 2 entries, got 1",
        ),
        (Rig, "width = 2\nheight = 2\ncameras = 1", "cameras must be a list, got a whole number"),
        (
            Notes,
            "[[note]]\nframe = 1\ndepth.torso = 'up'",
            "note 1, depth must be away, toward or auto, got 'up'",
        ),
    ],
)
def test_a_mistake_is_named_with_its_place_and_what_may_stand_there(
    kind: type, text: str, said: str
) -> None:
    with pytest.raises(msgspec.DecodeError) as caught:
        msgspec.toml.decode(text, type=kind)
    assert explained(caught.value, kind) == said
