"""Teaching the network of landmarks on videos that the user has, by another pose estimator."""
