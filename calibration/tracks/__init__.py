"""The joints in both views over time: tracks, sight lines, and the delay between views."""
