def record(path, *a): path.write_text("x")
