"""Metrics as Prometheus reads them, by its own parser."""

from typing import NamedTuple

from prometheus_client.parser import text_string_to_metric_families


class Samples(NamedTuple):
    """What was read."""

    families: list[str]
    samples: list[tuple[str, dict[str, str], float]]

    def by(self, label: str, name: str, **labels: str) -> dict[str, float]:
        """Every sample of a name with these labels, by one more label."""
        return {
            own.get(label, ""): value
            for each, own, value in self.samples
            if each == name and labels.items() <= own.items()
        }

    def value(self, name: str, **labels: str) -> float:
        """The only one of them."""
        (value,) = self.by("", name, **labels).values()
        return value


def read(text: str) -> Samples:
    """All samples of a text."""
    found = list(text_string_to_metric_families(text))
    samples = [(one.name, one.labels, one.value) for each in found for one in each.samples]
    return Samples([each.name for each in found], samples)
