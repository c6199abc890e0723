"""Which contestant for which work: mixes of tasks, their totals, who is first, and where the choice flips."""
