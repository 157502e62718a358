"""How many examples a property test takes."""

from hypothesis import settings


def examples(count: int) -> int:
    """`count` where the profile is the full one, and less in proportion where it is a faster one."""
    return max(5, count * settings().max_examples // 100)
