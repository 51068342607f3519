"""The paper's integration: arbiter, fusion, votes by both silhouettes (sections 4.2 to 4.4)."""
