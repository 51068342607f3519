"""The front door: the commands, the processes that they start, and what programs import."""

from tritrack.client import Subscription, subscribe, track

__all__ = ["Subscription", "subscribe", "track"]
