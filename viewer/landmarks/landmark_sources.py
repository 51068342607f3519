"""Which source outside a run's settings name, for each of its views."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.video.clip_facts import ClipView
from common.video.clip_sources import sources_of
from viewer.landmarks.keypoint_files import KeypointFiles
from viewer.landmarks.landmark_looks import refuse_no_network
from viewer.landmarks.mediapipe_source import MediaPipe, refuse_where_missing
from viewer.landmarks.outside_source import OutsideSource

Sources = Mapping[ViewerNumber, OutsideSource]
"""Sources of landmarks outside of the program, by view; empty where the settings name none."""


@contextmanager
def outside_sources(settings: Settings, views: Sequence[ClipView]) -> Iterator[Sources]:
    """The sources of these views, ready to be asked, and ended when all is done.

    Args:
        settings: Of the run; `landmarks` names the source.
        views: Those that are looked at in this process.

    Raises:
        SettingsError: When MediaPipe is not there or does not work, or the keypoint files are not.
    """
    with ExitStack() as doors:
        if settings.looks_itself or settings.landmarks == "none":
            yield {}
        elif settings.landmarks == "mediapipe":
            asked = {view.number: doors.enter_context(MediaPipe(view)) for view in views}
            for source in asked.values():
                source.ready()
            yield asked
        else:
            yield _files(settings, views)


def refuse_landmarks(settings: Settings, views: Sequence[ClipView]) -> None:
    """Say before any process starts what `outside_sources` would fail on in one of them.

    Raises:
        SettingsError: As there, and when a network of one's own is none; that an installed
            MediaPipe does not work is not found out.
    """
    if settings.landmarks == "mediapipe":
        refuse_where_missing()
    elif settings.looks_itself:
        refuse_no_network(settings.landmarks)
    elif settings.landmarks != "none":
        _files(settings, views)


def _files(settings: Settings, views: Sequence[ClipView]) -> dict[ViewerNumber, KeypointFiles]:
    alone = len(sources_of(settings)) == 1
    folder = Path(settings.landmarks)
    return {view.number: KeypointFiles(folder, view, alone) for view in views}


def oddities(sources: Sources) -> list[str]:
    """What went wrong with any of them, a line each."""
    return [line for source in sources.values() for line in source.odd]
