"""The steps at work: lock-step and live processes, run folders, sites, metrics, keys, bridges."""
