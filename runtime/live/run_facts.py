"""The summary of a live run."""

import msgspec

from common.npz_file import Facts
from common.video.clip_facts import Clip, clip_summary
from runtime.live.launch import Heard
from runtime.live.recorded import SoFar
from runtime.live.screen import warnings_of
from runtime.moved_facts import facts_of_moves
from runtime.odd_view import live_odd_camera_facts
from runtime.store.other_run import run_of
from runtime.store.runs import NO_PERSON_SEEN


def facts_of(heard: Heard, clip: Clip, seconds: float, so_far: SoFar) -> Facts:
    """The summary of a run so far.

    Args:
        heard: The messages of its parts.
        clip: The run's clip.
        seconds: Duration.
        so_far: Facts of the bodies and postures: all, or those of a part.
    """
    source = heard.cameras[-1].scale_source if heard.cameras else None
    warnings = [*clip.warnings, *warnings_of(heard.pulses), *heard.notes]
    return {
        **facts_of_clip(clip),
        "seconds": {"all": round(seconds, 3)},
        "scale_source": source,
        **_calibration(heard),
        **live_odd_camera_facts(clip, heard.cameras),
        **facts_of_moves(so_far.moves),
        "posture": so_far.posture,
        **_postures(so_far),
        "warnings": list(dict.fromkeys(warnings)),
        "processes": {
            name: {
                key: round(value, 3) if isinstance(value, float) else value
                for key, value in msgspec.to_builtins(pulse).items()
                if key not in ("protocol", "process", "detail")
            }
            for name, pulse in sorted(heard.pulses.items())
        },
    }


def _postures(so_far: SoFar) -> Facts:
    """By number of each of several people, as JSON has it."""
    named = {str(person): name for person, name in sorted(so_far.postures.items())}
    return {"postures": named} if named else {}


def note_lost(heard: Heard) -> None:
    """Warn how many of the first frames of a very long run are in no file."""
    given_up = 0 if heard.journal is None else heard.journal.let_go
    lost = min(given_up, heard.bodies.let_go)
    if lost:
        heard.notes.append(
            f"the first {lost} frames of a long run are not in poses.npz: write shorter runs, "
            "or follow recordings with: tritrack track"
        )


def note_unseen(heard: Heard) -> None:
    """Warn where frames came, and none of them shows a person."""
    if heard.so_far.instants and not heard.so_far.with_person:
        heard.notes.append(NO_PERSON_SEEN)


def facts_of_clip(clip: Clip) -> Facts:
    """The run's identity, and the clip's own data about performer and posture."""
    return {
        **clip_summary(clip),
        **run_of("live", [view.source for view in clip.views]).facts,
    }


def _calibration(heard: Heard) -> Facts:
    """The rig found by the person, in the form of a calibration.json."""
    told = heard.cameras[-1] if heard.cameras else None
    if told is None or told.scale_source != "person":
        return {}
    return {"calibration": {**msgspec.to_builtins(told.rig), "late_s": told.late_s}}
