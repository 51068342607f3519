"""A source that is decoded once: what a second reading gives, and when it is decoded again."""

from collections.abc import Iterator
from itertools import islice

import numpy as np

from common.video.pictures import ALL, Decoded, Ending, Size, Source, Wanted
from runtime.steps.frame_cache import FrameCache, Told

SIZE = (4, 3)
BYTES = 3 * SIZE[0] * SIZE[1]


class Counting:
    """A decoder of films of ten pictures that counts its readings."""

    def __init__(self) -> None:
        self.ending, self.readings = Ending(), 0

    def frames(self, source: Source, size: Size, wanted: Wanted = ALL) -> Iterator[Decoded]:
        self.readings += 1
        for index in range(-(-wanted.start // wanted.every) * wanted.every, 10, wanted.every):
            picture = np.full((size[1], size[0], 3), hash(source) % 7 + index, np.uint8)
            yield Decoded(index, 0.1 * index, picture, picture if wanted.large else None)
        self.ending = Ending(10)


def indices(frame_cache: FrameCache, source: Source = "a.avi", every: int = 1) -> list[int]:
    return [got.index for got in frame_cache.frames(source, SIZE, Wanted(every))]


def test_a_second_reading_gives_the_same_pictures_without_decoding() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    first, second = list(frame_cache.frames("a.avi", SIZE)), list(frame_cache.frames("a.avi", SIZE))
    assert all(one is other for one, other in zip(first, second, strict=True))
    assert decoder.readings == 1
    assert frame_cache.ending == Ending(10)


def test_every_third_picture_comes_from_a_whole_reading_too() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    indices(frame_cache)
    assert indices(frame_cache, every=3) == [0, 3, 6, 9]
    assert decoder.readings == 1


def test_a_reading_of_every_third_picture_is_not_taken_for_a_whole_one() -> None:
    frame_cache = FrameCache(Counting())
    assert indices(frame_cache, every=3) == [0, 3, 6, 9]
    assert indices(frame_cache) == list(range(10))


def test_a_film_that_is_too_large_is_decoded_again() -> None:
    decoder = Counting()
    small, fitting = FrameCache(decoder, 9 * BYTES), FrameCache(decoder, 10 * BYTES)
    for frame_cache, readings in ((small, 2), (fitting, 1)):
        decoder.readings = 0
        assert indices(frame_cache) == indices(frame_cache) == list(range(10))
        assert decoder.readings == readings


def test_of_a_film_that_claims_to_be_too_large_nothing_is_kept() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder, 10 * BYTES, due=11)
    assert indices(frame_cache) == indices(frame_cache) == list(range(10))
    assert decoder.readings == 2


def test_a_reading_may_start_anywhere_whether_it_was_kept_or_not() -> None:
    frame_cache = FrameCache(Counting())
    for _ in range(2):
        assert [got.index for got in frame_cache.frames("a.avi", SIZE, Wanted(start=7))] == [
            7,
            8,
            9,
        ]
        assert [got.index for got in frame_cache.frames("a.avi", SIZE, Wanted(3, start=4))] == [
            6,
            9,
        ]
        assert indices(frame_cache) == list(range(10))


def test_a_reading_that_was_broken_off_is_begun_afresh() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    list(islice(frame_cache.frames("a.avi", SIZE), 5))
    assert indices(frame_cache) == list(range(10))
    assert decoder.readings == 2


def test_another_source_or_size_is_decoded() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    indices(frame_cache, "plate.png")
    indices(frame_cache, "a.avi")
    assert next(iter(frame_cache.frames("a.avi", (8, 6)))).picture.shape == (6, 8, 3)
    assert decoder.readings == 3


def test_larger_pictures_are_decoded_for_whoever_asks_and_are_not_kept() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    indices(frame_cache)
    asked = list(frame_cache.frames("a.avi", SIZE, Wanted(large=(8, 6))))
    assert all(got.large is not None for got in asked)
    assert all(got.large is None for got in frame_cache.frames("a.avi", SIZE))
    assert decoder.readings == 2


def test_who_waits_is_told_which_share_of_the_due_frames_has_come() -> None:
    heard: list[float] = []
    told = Told(Counting(), 4, heard.append)
    assert [got.index for got in told.frames("a.avi", SIZE)] == list(range(10))
    assert heard == [0.25, 0.5, 0.75, *[1.0] * 7]
    assert told.ending == Ending(10)


def test_a_turned_reading_is_kept_for_readings_turned_as_much() -> None:
    decoder = Counting()
    frame_cache = FrameCache(decoder)
    for quarters, readings in ((1, 1), (1, 1), (0, 2), (0, 2), (1, 3)):
        turned = Wanted(quarters=quarters)
        assert len(list(frame_cache.frames("a.avi", SIZE, turned))) == 10
        assert decoder.readings == readings
    assert [got.index for got in frame_cache.frames("a.avi", SIZE, Wanted(2, 3, quarters=1))] == [
        4,
        6,
        8,
    ]
    assert decoder.readings == 3


def test_a_share_is_of_one_frame_at_least() -> None:
    heard: list[float] = []
    assert len(list(Told(Counting(), 0, heard.append).frames("a.avi", SIZE))) == 10
    assert heard == [1.0] * 10
    thirds: list[float] = []
    told = Told(Counting(), 12, thirds.append)
    assert [got.index for got in told.frames("a.avi", SIZE, Wanted(4))] == [0, 4, 8]
    assert thirds == [1 / 12, 5 / 12, 9 / 12]
