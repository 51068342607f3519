"""A given rig of which one camera contradicts all others: it is turned back, which is announced."""

from collections.abc import Sequence

import msgspec

from calibration.gate import odd_camera
from calibration.gate.odd_camera import OddCamera
from calibration.tracks.camera_clocks import Clocks
from calibration.tracks.joint_tracks import Sightings
from common.bus.control_messages import Cameras
from common.bus.messages import place_in_rig
from common.npz_file import Facts
from common.video.clip_facts import Clip
from common.video.upright_views import filed_rig


def odd_camera_of(clip: Clip, everyone: Sequence[Sightings], clocks: Clocks) -> OddCamera | None:
    """The odd camera of a clip's rig; None: there is none, or no rig.

    Args:
        clip: The clip as it was tracked.
        everyone: All views of each person.
        clocks: Clocks of the views after the first.
    """
    return None if clip.rig is None else odd_camera.odd_camera(clip.rig, everyone, clocks)


def turned_clip(clip: Clip, odd: OddCamera) -> Clip:
    """The clip with a camera of its rig turned back."""
    assert clip.rig is not None
    return msgspec.structs.replace(clip, rig=odd_camera.turned_back(clip.rig, odd))


def odd_camera_facts(clip: Clip, odd: OddCamera | None) -> Facts:
    """For the summary: the camera that was turned back, and where it looks now; nothing where none
    was."""
    rig = filed_rig(clip)
    if odd is None or rig is None:
        return {}
    return {
        "odd_camera": {
            "camera": clip.views[odd.place].name,
            "turned_deg": odd.turned_deg,
            "apart_mm": 1e3 * odd.apart_m,
            "then_mm": 1e3 * odd.then_m,
            "R": rig.cameras[odd.place].R,
            "t": rig.cameras[odd.place].t,
        }
    }


def odd_camera_warnings(facts: Facts) -> list[str]:
    """The warning about a camera that was turned back."""
    odd = facts.get("odd_camera")
    if odd is None:
        return []
    return [
        odd_camera.report_of(
            odd["camera"], odd["turned_deg"], odd["apart_mm"], odd["then_mm"], "in this run"
        )
    ]


def live_odd_camera_facts(clip: Clip, rigs: Sequence[Cameras]) -> Facts:
    """The same for a live run, of the rigs that it announced."""
    last = next((each for each in reversed(rigs) if each.odd is not None), None)
    if last is None or last.odd is None:
        return {}
    odd = OddCamera(place_in_rig(last.odd.camera), *msgspec.structs.astuple(last.odd)[1:])
    return odd_camera_facts(msgspec.structs.replace(clip, rig=last.rig), odd)
