"""What an instant of a program's own loop gives."""

from collections.abc import Iterator

import msgspec

from common.bus.messages import Body
from common.npz_file import Facts
from runtime.store.pose_arrays import poses


class Bodies(msgspec.Struct, frozen=True):
    """The bodies of one instant, to iterate over."""

    people: tuple[Body, ...]
    cameras: tuple[str, ...] = ()
    """Names of the rig's cameras."""

    def __iter__(self) -> Iterator[Body]:
        """Iterate over the bodies."""
        return iter(self.people)

    def __len__(self) -> int:
        """Their number; an unseen person counts as one, of status `empty` or `lost`."""
        return len(self.people)

    def __getitem__(self, place: int) -> Body:
        """One of them."""
        return self.people[place]

    def to_numpy(self) -> Facts:
        """As the arrays of `poses.npz`, one row per body: `joints_m` (n, 15, 3) and so on."""
        return poses(self.people, self.cameras)
