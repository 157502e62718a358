"""The profiles of the codec: what differs from one to the next, in one place each."""

from sgicodec.profiles.default import DEFAULT
from sgicodec.profiles.paper import PAPER
from sgicodec.profiles.profile import Profile

__all__ = ["DEFAULT", "PAPER", "PROFILES", "Profile"]

PROFILES = {profile.name: profile for profile in (DEFAULT, PAPER)}
"""By name."""
