"""The silhouette of the one person in a frame (section 1: subtraction, threshold, cleaning)."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.observation import Box
from common.config.part_settings import SilhouetteSettings
from common.method import DEFAULT, Method
from common.raster.silhouette_report import box_of, is_cut
from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.background.background import DARK, Background, BackgroundModel, learn, light_gain
from viewer.background.image_stack import Bytes, Floats
from viewer.background.moved_objects import Patch
from viewer.silhouette.boundary_features import counts_3x3, features_of
from viewer.silhouette.colour_model import body_colours_of, counted, fresh
from viewer.silhouette.difference import adapted, label, seeds
from viewer.silhouette.pixel_classifier import log_odds, redraw, shipped
from viewer.silhouette.printed_silhouette import printed
from viewer.silhouette.regions import chosen

CELLS: Final = 60
"""Rows of the coarse picture on which regions are distinguished."""
HOLE_SHARE: Final = 0.001
"""Holes up to this share of the picture are closed; between arm and trunk there are larger."""
SETTLES: Final = 10
"""Frames after which what the landmarks say is a thing is background: two thirds of a second."""
PART_SHARE: Final = 0.0002
"""Specks below this share of the picture are dropped."""
ADAPT_EVERY: Final = 8
"""Frames between two looks at the slow light."""


class Seen(NamedTuple):
    """What of a person a frame shows."""

    mask: Mask
    box: Box | None
    """None where no person is seen; the mask is empty then."""
    area_px: int
    blobs: int
    """How many regions were large enough to be a person (P4)."""
    cut: bool
    """The silhouette touches the picture's border."""
    is_guess: bool = False
    """It is by difference from a background that is an estimate."""


class State(NamedTuple):
    """What one frame hands to the next."""

    settings: SilhouetteSettings
    method: Method
    background: Background
    """As it was learnt."""
    model: BackgroundModel
    """What frames are held against: as it has become."""
    colours: Floats
    """(2, SHADES) counts of the colours of background and body, see `colour_model`."""
    frames: int
    is_known: bool = True
    """False: there is no background, and so no silhouette by what differs from it."""
    is_estimate: bool = False
    """Of the background; its silhouettes are guesses."""
    doubted: Bytes | None = None
    """(H, W) for how many frames each pixel has been a thing's, by the landmarks; None: none."""


class Guess(NamedTuple):
    """What subtraction and known colours make of a frame."""

    cells: Bytes
    """(rows, columns) 1 around the person."""
    cell: int
    """Pixels in a cell's side."""
    blobs: int
    mask: Bytes
    """(H, W) 1 where the person is."""
    places: NDArray[np.int32]
    """Row and column (n, 2) of the pixels to look at again."""
    features: Floats
    """(n, FEATURES) what is known of them."""


def init(background: Background, settings: SilhouetteSettings, method: Method) -> State:
    """Begin with the background as it was learnt."""
    weight, colours = np.float32(1) / background.spread**2, fresh()
    even = np.ones(3, np.float32)
    model = BackgroundModel(background.centre, weight, even, body_colours_of(colours))
    is_known, is_estimate = not background.uncertain.all(), background.is_estimate
    return State(settings, method, background, model, colours, 0, is_known, is_estimate)


def step(state: State, frame: Image, near_px: tuple[float, float] | None) -> tuple[State, Seen]:
    """Find the person in a frame.

    Args:
        state: From `init` or the step before.
        frame: (H, W, 3) at the background's size.
        near_px: Where the centre of the body is expected; None: the largest region is taken.

    Raises:
        ValueError: When the frame is not of the background's size.

    Source: Huang & Chung 2004, section 1; requirements P3, P4, T8.
    """
    size = state.model.centre.shape
    if frame.shape != size:
        raise ValueError(f"a frame of {frame.shape}, the background has {size}")
    if not state.is_known:
        return state, seen_of(np.zeros(size[:2], np.uint8), 0, 1.0)
    least_share, method = state.settings.min_height_share, state.method
    state = in_light_of(state, frame)
    if not method.pixel_evidence:
        gain, least_rows = state.model.gain, least_share * frame.shape[0]
        found = printed(state.background, frame, gain, least_rows, near_px)
        return state, seen_of(found.mask, found.blobs, least_share)
    first = guess(state, frame, near_px)
    mask = _reclassified(first) if method.alpha_matte else first.mask
    seen = seen_of(mask, first.blobs, least_share)._replace(is_guess=state.is_estimate)
    if seen.box is not None and method.body_colours:
        state = learn_colours(state, mask, frame, first)
    return _adapted(state, frame, seen.box) if method.slow_light else state, seen


def at(state: State, frame: Image, near_px: tuple[float, float]) -> Seen:
    """Another person in a frame that `step` has processed; nothing without a background.

    Args:
        state: After `step`, in the light of the frame.
        frame: (H, W, 3).
        near_px: Where the centre of the body is.
    """
    if not state.is_known:
        return seen_of(np.zeros(frame.shape[:2], np.uint8), 0, 1.0)
    first = guess(state, frame, near_px)
    return seen_of(_reclassified(first), first.blobs, state.settings.min_height_share)


def warm() -> None:
    """Compile every kernel (seconds, once on a host), so that no frame has to wait for it."""
    empty = np.full((120, 160, 3), 128, np.uint8)
    person = cv2.rectangle(empty.copy(), (60, 30), (100, 90), (0, 0, 0), cv2.FILLED)
    state = init(learn([empty]), SilhouetteSettings(), DEFAULT)
    for _ in range(ADAPT_EVERY):
        state, _ = step(state, person, None)


def guess(state: State, frame: Image, near_px: tuple[float, float] | None) -> Guess:
    """Find the person by subtraction and known colours, and what refines the contour.

    Args:
        state: In the light of the frame.
        frame: (H, W, 3).
        near_px: As for `step`.
    """
    model, cell = state.model, max(1, round(frame.shape[0] / CELLS))
    found = seeds(frame, model, cell)
    near = None if near_px is None else (near_px[0] / cell, near_px[1] / cell)
    cells, blobs = chosen(found, state.settings.min_height_share, near)
    mask, doubt = np.zeros(frame.shape[:2], np.uint8), np.zeros(frame.shape[:2], np.uint8)
    if blobs:
        label(mask, doubt, frame, model, cells, cell)
    return Guess(cells, cell, blobs, mask, *features_of(frame, model, mask, doubt))


def before(state: State, background: Background) -> State:
    """Silhouettes before another background; whose colours are whose is kept."""
    fresh_state = init(background, state.settings, state.method)
    model = fresh_state.model._replace(body_colours=state.model.body_colours)
    return fresh_state._replace(model=model, colours=state.colours)


def patched(state: State, patch: Patch) -> State:
    """Silhouettes in a background with a patch on it."""
    centre, weight = state.model.centre.copy(), state.model.weight.copy()
    centre[patch.where] = patch.centre
    weight[patch.where] = np.float32(1) / patch.spread**2
    return state._replace(model=state.model._replace(centre=centre, weight=weight))


def in_light_of(state: State, frame: Image) -> State:
    """The background as bright as a frame is, whoever stands in it."""
    if not state.method.steady_light:
        return state
    gain = light_gain(frame, state.model.centre)
    return state._replace(model=state.model._replace(gain=gain))


def without_things(state: State, before: State, frame: Image, things: Bytes | None) -> State:
    """The state after a frame whose silhouette was not the body's alone.

    What it showed of colours is forgotten. A thing that stays, a door that was opened, a person's
    place when the room was learnt with them in it, becomes background.

    Args:
        state: After the frame, in its light.
        before: Before it.
        frame: (H, W, 3).
        things: (H, W) 1 where the silhouette is not the body's; None: the body's is not whole.
    """
    model = state.model._replace(body_colours=before.model.body_colours)
    state = state._replace(colours=before.colours, model=model)
    if things is None:
        return state._replace(doubted=None)
    known = np.zeros_like(things) if state.doubted is None else state.doubted
    doubted = (known + np.uint8(1)) * things
    stays = doubted >= SETTLES
    if not stays.any():
        return state._replace(doubted=doubted)
    centre = model.centre.copy()
    centre[stays] = frame[stays] / model.gain
    doubted[stays] = 0
    return state._replace(doubted=doubted, model=model._replace(centre=centre))


def learn_colours(state: State, mask: Bytes, frame: Image, first: Guess) -> State:
    """Count whose colours are whose, by a mask of the body; the state is in the frame's light."""
    inside = counts_3x3(mask)
    colours = counted(state.colours, inside, frame, state.model, first.cells, first.cell)
    model = state.model._replace(body_colours=body_colours_of(colours))
    return state._replace(model=model, colours=colours)


def _reclassified(first: Guess) -> Bytes:
    """The mask with the pixels around its contour decided by the classifier, and cleaned."""
    mask = first.mask.copy()
    redraw(mask, first.places, log_odds(shipped(), first.features))
    _tidy(mask)
    return mask


def _tidy(mask: Bytes) -> None:
    """Close small holes and drop specks, in place."""
    contours, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    for number, contour in enumerate(contours):
        hole = tree[0, number, 3] >= 0
        limit = (HOLE_SHARE if hole else PART_SHARE) * mask.size
        if len(contour) < 4 * limit and cv2.contourArea(contour) < limit:
            cv2.drawContours(mask, [contour], 0, int(hole), cv2.FILLED)


def seen_of(mask: Bytes, blobs: int, least_share: float) -> Seen:
    """What a mask (H, W) shows; nothing where it is lower than a person."""
    box = box_of(mask)
    if box is None or box.bottom + 1 - box.top < least_share * mask.shape[0]:
        return Seen(np.zeros(mask.shape, np.bool_), None, 0, 0, cut=False)
    return Seen(mask.view(np.bool_), box, cv2.countNonZero(mask), blobs, is_cut(box, mask.shape))


def _adapted(state: State, frame: Image, box: Box | None) -> State:
    """The background takes on the slow light, but nothing near the person."""
    frames = state.frames + 1
    if frames % ADAPT_EVERY or state.model.gain.min() < DARK:
        return state._replace(frames=frames)
    margin = frame.shape[0] // 12
    corners = (1, 0, 1, 0)
    if box is not None:
        corners = (box.left - margin, box.right + margin, box.top - margin, box.bottom + margin)
    model = state.model._replace(centre=adapted(frame, state.model, corners))
    if state.method.steady_light:
        model = _as_bright_as(state.background, model)
    return state._replace(model=model, frames=frames)


def _as_bright_as(background: Background, model: BackgroundModel) -> BackgroundModel:
    """What frames are held against, as bright as the background was learnt; the gain has the rest.

    Only their product is seen. A person's shading, a little each time, would let the one grow and
    the other shrink for hours, until all is white.
    """
    learnt, now = cv2.mean(background.centre)[:3], cv2.mean(model.centre)[:3]
    more = np.divide(np.maximum(now, 1.0), np.maximum(learnt, 1.0)).astype(np.float32)
    return model._replace(centre=model.centre / more, gain=model.gain * more)
