"""What the network of landmarks is taught with: its layers, its pictures, its loss, its file."""
