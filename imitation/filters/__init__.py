"""State estimation: beliefs over a state s_t from the raw input I_t (chapter 3.2), for any body or image."""
