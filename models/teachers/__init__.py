"""Teachers: robots and humans whose movements can be watched."""
