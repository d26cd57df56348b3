"""What proves the references of the chapter: each oracle says its way in its docstring."""

# 12a, equations

# 12b, grading
