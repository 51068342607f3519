"""The background of a view: from a plate, from the clip's opening frames, or from the clip."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from common.atomic_file import replacing
from common.body.observation import Landmarks
from common.config.part_settings import SilhouetteSettings
from common.video.clip_facts import ClipView
from common.video.clip_sources import ClipError
from common.video.decoding import Decoder
from common.video.pictures import Image, Reader, Source, Wanted, named
from viewer.background.background import (
    Background,
    even_light,
    learn,
    learnt,
    lit,
    overlaid_opening,
    unknown,
)
from viewer.background.empty_opening import is_empty_opening, is_still
from viewer.background.hidden_background import learn_behind
from viewer.background.image_stack import median
from viewer.background.moved_objects import Patch, patches_of
from viewer.background.occluded_background import learn_around, learn_uncovered
from viewer.room.judged_background import best_of
from viewer.room.room_people import AROUND, are_sure, looked_at
from viewer.room.standing_body import standing

SAMPLE = 40
"""How many frames at most, spread over a clip, decide whether its opening is empty."""
LOOKED_AT = 1500
"""How many frames of a clip are looked at for that: a long recording is judged by its start."""

PEOPLE = 20
"""How many of these frames are searched for people, where the opening is in doubt."""

FILM_OPTION = "--background"
"""Where the one command that follows videos, `tritrack single`, is given an empty picture."""


class Opening(NamedTuple):
    """What a viewer knows of a recorded view before its first frame."""

    background: Background
    odd: str
    """What is odd about how that is known; "" if nothing is."""
    somebody: Landmarks | None
    """Of the first frame, where all of the clip was looked at and shows who is there."""


class VideoBackground(NamedTuple):
    """The picture of one camera without people, all through a video."""

    background: Background
    patches: list[Patch]
    """What is another from some frame on."""
    odd: str
    """What is odd about how that is known; "" if nothing is."""


def opening_of_view(view: ClipView, settings: SilhouetteSettings, decoder: Reader) -> Opening:
    """What a view shows without the person, and who is seen first.

    Args:
        view: A recorded file's, or a camera's: no person is taken to be before that one now.
        settings: How long no person is in view at first.
        decoder: Reads the file; left at its start.

    Raises:
        Undecodable: When the plate or the file has no picture.
        DecoderDied: When the decoder broke on it.
    """
    if settings.background == "none":
        (first,) = islice(_pictures(decoder, view.source, view), 1)
        return Opening(unknown(first), "", None)
    if isinstance(view.source, int) and not view.background:
        return Opening(learn(_now(view, settings, decoder)), "", None)
    if view.background:
        plate = list(islice(_pictures(decoder, view.background, view), SAMPLE))
        return Opening(learn(plate), "", None)
    opening, coming = _looked_at(view, settings, decoder)
    return of_clip(opening, list(coming), settings, view)


def of_clip(
    opening: Sequence[Image], sample: Sequence[Image], settings: SilhouetteSettings, view: ClipView
) -> Opening:
    """The background of a clip, what is odd about how that is known, and who is seen first.

    Where contours say that no person is in the opening, that is the room. They do take furniture
    for
    somebody: then the network of landmarks is asked, and the backgrounds of both cases are made,
    the likelier first, until one has the silhouettes that the landmarks in later frames ask for. Of
    what changes and, where the network is sure, of who hides the same place all through, one is
    estimated each: the better.

    Args:
        opening: The first frames.
        sample: Frames from all over the clip.
        settings: How a person is distinguished from the background.
        view: Is named in what is odd.
    """
    opening = lit(opening)
    laid_over = overlaid_opening(opening)
    still = is_still(laid_over)
    if still and is_empty_opening(laid_over, sample):
        return Opening(learnt(laid_over, opening), "", None)
    somebody = looked_at(opening[:1])[0].is_somebody
    judges = sample[:: max(1, math.ceil(len(sample) / PEOPLE))]
    looks = looked_at(judges)
    regions = [look.region(judges[0].shape, AROUND) for look in looks]
    opened = learnt(laid_over, opening)
    groups: list[list[Callable[[], Background]]] = [[lambda: learn_uncovered(sample)]]
    if any(look.is_somebody for look in looks):
        if are_sure(looks):
            body = standing(median(even_light(judges)), looks)
            groups[0].append(lambda: learn_behind(judges, body, regions))
        groups.append([lambda: learn_around(judges, regions)])
        if still:
            groups.insert(len(groups) if somebody else 0, [lambda: opened])
    best = best_of(groups, judges, looks, settings)
    if best is opened:
        return Opening(best, "", None)
    odd = _estimated(view, f"cameras.{view.name}.background")
    first = looks[0].landmarks if looks[0].is_somebody and are_sure(looks) else None
    return Opening(best, odd, first)


def _estimated(view: ClipView, setting: str) -> str:
    """What is odd about a background that no empty picture shows, and where to name one."""
    return (
        f"{view.source} does not open with an empty room: the background is estimated from the "
        f"clip (name an empty picture with {setting})"
    )


def opening_of_run(
    view: ClipView, settings: SilhouetteSettings, decoder: Decoder, kept: Path | None
) -> Opening:
    """The same in a live run, where a viewer may be started again with a person before its camera.

    Args:
        view: As above; likewise `settings`, `decoder`.
        kept: The run's folder for what was learnt of a camera's background; None: it keeps nothing.

    Raises:
        ClipError: When the camera's pictures are not of the size that they were.
    """
    if kept is None or not isinstance(view.source, int) or settings.background == "none":
        return opening_of_view(view, settings, decoder)
    path = kept / _name_of(view)
    if path.exists():
        with np.load(path, allow_pickle=False) as found:
            known = Background(**found)
        _refuse_another_size(view, known)
        return Opening(known, "", None)
    opening = opening_of_view(view, settings, decoder)
    if not view.background:
        keep(kept, view, opening.background)
    return opening


def _refuse_another_size(view: ClipView, known: Background) -> None:
    """The rig is of the pictures that the run began with."""
    height, width = known.centre.shape[:2]
    if view.size != (width, height):
        began, now = f"{width}x{height}", "{}x{}".format(*view.size)
        raise ClipError(
            f"{named(view.source)} gives pictures of another shape than the run began with "
            f"({now} at the working size, {began} then): start the run anew"
        )


def keep(kept: Path, view: ClipView, background: Background) -> None:
    """Write down what was learnt of a camera's background: its viewer may be started again.

    Args:
        kept: As for `opening_of_run`.
        view: The camera's.
        background: Its picture without people.
    """
    with replacing(kept / _name_of(view)) as new, new.open("wb") as file:
        np.savez(file, allow_pickle=False, **background._asdict())


def _name_of(view: ClipView) -> str:
    return f"background_{view.number}.npz"


def background_of_film(
    view: ClipView, settings: SilhouetteSettings, decoder: Reader
) -> VideoBackground:
    """The background of a video, from all over it where that shows enough, and what changes.

    Light changes through a video, and with it more than a gain can follow; an empty opening knows
    nothing of that. It is kept where a person stays on the spot. Things that come to rest or leave
    are patches on it, also on a background that was given.

    Args:
        view: Of the video; likewise `settings`, `decoder`: as for `opening_of_view`.
        settings: How long no person is in view at first.
        decoder: Reads the file; left at its start.
    """
    background, odd, _ = opening_of_view(view, settings, decoder)
    if isinstance(view.source, int) or settings.background == "none":
        return VideoBackground(background, [], odd)
    sample = list(_looked_at(view, settings, decoder)[1])
    if not (odd or view.background):
        busy = learn_uncovered(sample)
        background = background if busy.is_estimate else busy
    patches = patches_of(background, sample, _stride(view), view.fps)
    return VideoBackground(background, patches, odd and _estimated(view, FILM_OPTION))


def _pictures(decoder: Reader, source: Source, view: ClipView) -> Iterator[Image]:
    """Those of a source, as the view's are worked on."""
    wanted = Wanted(quarters=view.quarters)
    return (got.picture for got in decoder.frames(source, view.size, wanted))


def _now(view: ClipView, settings: SilhouetteSettings, decoder: Reader) -> list[Image]:
    """The first frames that a camera gives."""
    due = view.frames_in(settings.empty_s)
    return list(islice(_pictures(decoder, view.source, view), due))


def _looked_at(
    view: ClipView, settings: SilhouetteSettings, decoder: Reader
) -> tuple[list[Image], Iterator[Image]]:
    """The opening frames, and frames from everywhere in the clip: these as they are decoded."""
    pictures = islice(_pictures(decoder, view.source, view), LOOKED_AT)
    opening = list(islice(pictures, view.frames_in(settings.empty_s)))
    return opening, islice(chain(opening, pictures), 0, None, _stride(view))


def _stride(view: ClipView) -> int:
    """Frames from one that is looked at to the next."""
    return max(1, math.ceil(min(view.frames, LOOKED_AT) / SAMPLE))
