"""Access rules of a bus with keys: the table of rights by part, and the hub's configuration."""

from typing import Any, Final, NamedTuple

from common.bus.bus_keys import VIEWERS, Part
from common.bus.control_messages import Answer, Cameras, ClockQuestion, Command, Ended, Pulse
from common.bus.inbox import QUESTIONS
from common.bus.message_codec import TOPICS
from common.bus.messages import Guide, Message, Picture, Posture, View


class Right(NamedTuple):
    """What a part may publish and ask; every part may subscribe to everything in its site."""

    process: str = ""
    """The part's name on the bus; "": it does not announce itself."""
    says: tuple[type[Message], ...] = ()
    asks: tuple[type[Message], ...] = ()
    viewer: int = 0


_VIEWER: Final = (View, Picture, Ended, Pulse, Answer), (ClockQuestion,)
RIGHTS: Final[dict[Part, Right]] = {
    **{part: Right(f"viewer {n}", *_VIEWER, viewer=n) for n, part in VIEWERS.items()},
    "recognizer": Right("recognizer", (Posture, Pulse), (ClockQuestion,)),
    "animator": Right("animator", (Command, Pulse)),
    "supervisor": Right(says=(Answer,)),
    "metrics": Right("metrics", (Pulse,)),
    "client": Right(),
}
"""The rights of all that connect; nothing asks the hub itself."""

KEPT: Final = (Guide, Cameras)
"""The kinds whose newest message every part may ask the hub for."""

HEARING: Final = ("declare_subscriber", "declare_liveliness_subscriber", "liveliness_query")
SAYING: Final = ("put", "liveliness_token")
ALL: Final = (*HEARING, *SAYING, "delete", "query", "reply", "declare_queryable")


def access_of(room: str) -> dict[str, Any]:
    """Zenoh's `access_control` for the hub: what no rule allows is dropped on arrival."""
    everything = [f"tritrack/{room}/**"]
    kept = [TOPICS[kind].key.format(room=room) for kind in KEPT]
    rules = [
        _rule("is told", "egress", ALL, everything),
        _rule("hears", "ingress", HEARING, everything),
        _rule("asks for the newest", "ingress", ("query",), kept),
    ]
    subjects = [{"id": "all", "cert_common_names": list(RIGHTS)}]
    policies = [{"rules": [rule["id"] for rule in rules], "subjects": ["all"]}]
    for part, right in RIGHTS.items():
        own = [
            _rule(f"{part} says", "ingress", SAYING, _said_keys(right, room)),
            _rule(f"{part} asks", "ingress", ("query",), _asked_keys(right, room)),
        ]
        own = [rule for rule in own if rule["key_exprs"]]
        if own:
            rules += own
            subjects.append({"id": part, "cert_common_names": [part]})
            policies.append({"rules": [rule["id"] for rule in own], "subjects": [part]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _said_keys(right: Right, room: str) -> list[str]:
    fields = {"room": room, "viewer": right.viewer, "process": right.process}
    said = [TOPICS[kind].key.format(**fields) for kind in right.says]
    return [*said, *([f"tritrack/{room}/alive/{right.process}"] if right.process else [])]


def _asked_keys(right: Right, room: str) -> list[str]:
    return [QUESTIONS[kind].format(room=room) for kind in right.asks]


def _rule(name: str, flow: str, messages: tuple[str, ...], keys: list[str]) -> dict[str, Any]:
    return {
        "id": name,
        "permission": "allow",
        "flows": [flow],
        "messages": list(messages),
        "key_exprs": keys,
    }
