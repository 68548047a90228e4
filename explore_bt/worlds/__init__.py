"""Generated worlds: furnished flats, office floors, and a course of gaps."""

from explore_bt.worlds.generate import KINDS, generate_world

__all__ = ["KINDS", "generate_world"]
