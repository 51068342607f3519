"""Child processes: begun, named, ended with the process that began them."""
