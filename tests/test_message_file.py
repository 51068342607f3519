"""Messages on disk: a sequence like a list of them, that goes on from any place of it."""

from pathlib import Path

import pytest

from common.body.observation import Box, Observation
from common.bus.messages import Body, View
from runtime.unfinished.message_file import MessageFile, Place, Torn


def body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="tracking", views="both")


BOX = Box(0, 1, 0, 1)


def report(frame: int) -> View:
    return View(
        frame=frame,
        captured_s=frame / 15,
        clock_s=0.0,
        viewer=1,
        width=4,
        height=3,
        people=(Observation(width=4, height=3, silhouette=bytes(frame), box=BOX, area_px=0),),
    )


def test_it_is_the_list_of_what_was_appended(tmp_path: Path) -> None:
    file: MessageFile[Body | View] = MessageFile(tmp_path / "some.bin", b"head")
    held: list[Body | View] = []
    assert list(file) == held
    for n in range(30):
        held.append(report(n) if n % 3 else body(n))
        file.append(held[-1])
        if n % 7 == 0:
            assert list(file) == held
    assert (len(file), file[0], file[-1], file[11]) == (30, held[0], held[-1], held[11])
    assert file[5:25:4] == held[5:25:4]
    with pytest.raises(IndexError):
        file[30]
    file.close()
    assert list(file) == held


def test_it_goes_on_from_a_place_and_what_stood_behind_it_is_gone(tmp_path: Path) -> None:
    path = tmp_path / "some.bin"
    file: MessageFile[Body] = MessageFile(path, b"head")
    places = []
    for n in range(5):
        file.append(body(n))
        places.append(file.synced())
    file.close()
    again: MessageFile[Body] = MessageFile(path, b"head", places[2])
    again.append(body(9))
    assert [one.frame for one in again] == [0, 1, 2, 9]
    again.close()
    assert path.stat().st_size == places[3].size


def test_a_file_that_is_not_what_it_was_is_torn(tmp_path: Path) -> None:
    path = tmp_path / "some.bin"
    file: MessageFile[Body] = MessageFile(path)
    for n in range(5):
        file.append(body(n))
    place = file.synced()
    file.close()
    whole = path.read_bytes()
    for at in range(0, len(whole), 7):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        with pytest.raises(Torn):
            MessageFile(path, b"", place)
    path.write_bytes(whole[:-1])
    with pytest.raises(Torn, match="damaged after 4 messages"):
        MessageFile(path, b"", place)
    path.write_bytes(whole)
    with pytest.raises(Torn):
        MessageFile(path, b"", Place(6, place.size))
    path.unlink()
    with pytest.raises(Torn, match="cannot be read"):
        MessageFile(path, b"", place)
