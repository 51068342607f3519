"""Teaching the network of landmarks on films that the user has, by another pose estimator."""
