"""One camera: frames in, a report of one silhouette out."""
