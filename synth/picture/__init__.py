"""Pictures of synthetic people: rooms, light, rendering, and examples for training."""
