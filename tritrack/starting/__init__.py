"""The start page at work: files that were dropped, jobs, runs, cameras, calibrations."""
