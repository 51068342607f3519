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
