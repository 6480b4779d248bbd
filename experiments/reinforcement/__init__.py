"""The peer of the chapter's section 4: reinforcement learning on the same body."""
