"""The match-to-target loop and what it needs: belief, movement, sub-goals, rehearsal."""
