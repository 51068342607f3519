"""Imported by a process as it begins: from then on it ends with the process that started it."""

import os

from common.child.parent_death import end_with

end_with(os.getppid())
