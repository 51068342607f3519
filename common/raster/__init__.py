"""The matching kernel: bit-packed silhouettes, limbs drawn as row spans, similarity."""
