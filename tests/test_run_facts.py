"""What the summary of a live run tells, by what its parts said."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
from staging import RIG

from common.bus.control_messages import Cameras, Pulse
from common.bus.messages import Body, Posture
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.live.launch import nothing_heard
from runtime.live.recorded import SoFar
from runtime.live.run_facts import facts_of, facts_of_clip, note_lost

CLIP = Clip(
    "room",
    (
        ClipView(1, "cam1.avi", (160, 120), (160, 120), 15.0, 0),
        ClipView(2, 3, (8, 6), (8, 6), 15.0, 0),
    ),
    1,
    None,
    Meta("anna", "squat"),
    ("it is short",),
)


def pulse(name: str, **more: object) -> Pulse:
    return Pulse(process=name, state="running", **more)  # type: ignore[arg-type]


def test_a_summary_tells_each_process_each_warning_once_and_the_rig_of_the_person() -> None:
    heard = nothing_heard()
    told = Cameras(rig=RIG, scale_source="person", late_s=0.25)
    heard.cameras.extend([msgspec.structs.replace(told, late_s=0.5), told])
    heard.pulses["viewer 2"] = pulse("viewer 2", frames=7, fps=14.98765, detail="it is dark\nodd")
    heard.pulses["integrator"] = pulse("integrator", detail="it is short")
    heard.pulses["recognizer"] = pulse("recognizer", detail="squat")
    heard.notes.extend(["it is dark", "put aside"])
    so_far = SoFar([], [Posture(frame=0, captured_s=0.0, clock_s=0.0, name="kick_left_side")])
    facts = facts_of(heard, CLIP, 12.34567, so_far)
    assert {name: facts[name] for name in ("clip", "performer", "posture_meant", "posture")} == {
        "clip": "room",
        "performer": "anna",
        "posture_meant": "squat",
        "posture": "kick_left_side",
    }
    assert facts["seconds"] == {"all": 12.346}
    assert facts["scale_source"] == "person"
    assert facts["calibration"] == {**msgspec.to_builtins(RIG), "late_s": 0.25}
    assert facts["warnings"] == ["it is short", "it is dark", "odd", "put aside"]
    assert [*facts["processes"]] == ["integrator", "recognizer", "viewer 2"]
    viewer = facts["processes"]["viewer 2"]
    assert (viewer["state"], viewer["frames"], viewer["fps"]) == ("running", 7, 14.988)
    assert not viewer.keys() & {"protocol", "process", "detail"}


def test_a_summary_tells_the_posture_of_each_of_several_people() -> None:
    said = [
        Posture(frame=0, captured_s=0.0, clock_s=0.0, name=name, person=person)
        for person, name in ((2, "kick_left_side"), (1, "squat"))
    ]
    facts = facts_of(nothing_heard(), CLIP, 1.0, SoFar([], said))
    assert facts["postures"] == {"1": "squat", "2": "kick_left_side"}
    assert "postures" not in facts_of(nothing_heard(), CLIP, 1.0, SoFar())


def test_a_rig_that_the_person_did_not_tell_is_no_calibration_of_the_run() -> None:
    heard = nothing_heard()
    facts = facts_of(heard, CLIP, 1.0, SoFar())
    assert facts["scale_source"] is None
    assert "calibration" not in facts
    heard.cameras.append(Cameras(rig=RIG, scale_source="calibrated"))
    facts = facts_of(heard, CLIP, 1.0, SoFar())
    assert facts["scale_source"] == "calibrated"
    assert "calibration" not in facts


def test_cameras_that_were_moved_are_in_the_summary_of_these_bodies() -> None:
    """Of a part of the run as of all of it."""
    moved = Body(frame=3, captured_s=0.2, clock_s=0.2, status="tracking", views="both", moved=(2,))
    facts = facts_of(nothing_heard(), CLIP, 1.0, SoFar([moved]))
    still = facts_of(nothing_heard(), CLIP, 1.0, SoFar())
    assert len(facts) == len(still) + 1


def test_a_run_is_of_its_films_by_their_whole_paths_and_of_cameras_by_number() -> None:
    assert facts_of_clip(CLIP)["run_of"] == {
        "command": "live",
        "footage": [str(Path("cam1.avi").resolve()), "3"],
    }


@pytest.mark.parametrize(("of_journal", "of_memory", "lost"), [(5, 9, 5), (9, 4, 4), (0, 9, 0)])
def test_frames_are_lost_that_neither_memory_nor_the_journal_has(
    of_journal: int, of_memory: int, lost: int
) -> None:
    journal: Any = SimpleNamespace(let_go=of_journal)
    heard = nothing_heard()._replace(journal=journal)
    heard.bodies.let_go = of_memory
    note_lost(heard)
    told = [f"the first {lost} frames of a long run are not in poses.npz: write shorter runs, or "]
    assert [line[: len(told[0])] for line in heard.notes] == (told if lost else [])
