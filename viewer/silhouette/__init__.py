"""The person's silhouette: subtraction, colours, alpha matte, and whose it is."""
