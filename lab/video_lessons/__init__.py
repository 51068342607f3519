"""Training of the landmark network on a user's videos, with another pose estimator as teacher."""
