"""Simulated people who imitate a motion with a puppet.

No puppet and no users are here, so every query of an experiment is simulated and every table says so. The
model follows what [P] reports of its users; `users.Habits` sets each figure beside the sentence that it
models.
"""

from miburi.perform.puppeteer.imitation import imitate
from miburi.perform.puppeteer.users import SPLITS, STYLES, Habits, User, habits, users

__all__ = ["SPLITS", "STYLES", "Habits", "User", "habits", "imitate", "users"]
