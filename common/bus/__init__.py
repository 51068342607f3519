"""What the processes say to each other, and how: messages, topics, Zenoh, clocks, rates."""
