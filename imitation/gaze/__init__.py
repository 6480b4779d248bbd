"""Looking at things, and seeing what others look at."""
