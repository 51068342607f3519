"""What a live run keeps of what was said: the newest, as it was said."""

from common.bus.control_messages import Pulse
from tritrack.live.recorded import MessageLog


def test_no_more_than_the_bound_is_kept_and_what_gave_way_is_counted() -> None:
    """However long a run is, its supervisor takes no more room than this."""
    kept = MessageLog(Pulse, most=3)
    beats = [Pulse(process="viewer 1", state="running", frames=n) for n in range(8)]
    kept.add(beats[:2])
    assert (kept.all(), kept.let_go) == (beats[:2], 0)
    kept.add(beats[2:])
    assert (kept.all(), kept.let_go) == (beats[-3:], 5)


def test_the_newest_are_found_from_the_end_up_to_the_first_that_is_not_wanted() -> None:
    kept = MessageLog(Pulse)
    kept.add(Pulse(process="viewer 1", state="running", frames=n) for n in (9, 1, 7, 8))
    assert [pulse.frames for pulse in kept.newest(lambda each: each.frames > 5)] == [7, 8]
    assert [pulse.frames for pulse in kept.newest(lambda _: True, most=1)] == [8]
    assert MessageLog(Pulse).newest(lambda _: True) == []
