"""Several runs side by side: their figures, and their maps."""

from explore_bt.comparison.figures import Figure, figures_of
from explore_bt.comparison.notes import notes_on
from explore_bt.comparison.page import comparison_page
from explore_bt.comparison.run_facts import RunFacts, read_run

__all__ = ["Figure", "RunFacts", "comparison_page", "figures_of", "notes_on", "read_run"]
