"""What waits between two threads: the oldest gives way, and who wants the newest has it."""

import threading

from common.bus.mailbox import Mailbox


def test_the_oldest_comes_first_and_gives_way_first() -> None:
    box = Mailbox[int](3)
    for item in range(5):
        box.put(item)
    assert box.dropped == 2
    assert [box.take(0.0), box.take(0.0)] == [2, 3]
    box.put(5)
    assert box.drain() == [4, 5]
    assert (box.drain(), box.take(0.0), box.dropped) == ([], None, 2)


def test_of_a_slot_the_newest_alone_waits_behind_what_came_before_it() -> None:
    box = Mailbox[str](2)
    for item, slot in (("a1", "a"), ("b1", "b"), ("a2", "a")):
        box.put(item, slot)
    assert box.dropped == 0
    assert box.drain() == ["b1", "a2"]
    for slot in "abc":
        box.put(slot, slot)
    assert (box.drain(), box.dropped) == (["b", "c"], 1)


def test_a_closed_one_takes_nothing_in_and_wakes_who_waits() -> None:
    box, got = Mailbox[int](3), list[int | None]()
    waits = threading.Thread(target=lambda: got.append(box.take(20.0)))
    waits.start()
    box.close()
    waits.join(5.0)
    assert got == [None]
    box.put(1)
    assert (box.drain(), box.over) == ([], True)
    left = Mailbox[int](3)
    left.put(7)
    left.close()
    assert not left.over
    assert (left.take(0.0), left.over) == (7, True)


def test_who_waits_gets_what_is_put_meanwhile() -> None:
    box = Mailbox[int](3)
    later = threading.Timer(0.02, box.put, (9,))
    later.start()
    assert box.take(20.0) == 9
