"""What the source says of the fields of a class, for help."""

import ast
from inspect import getsource
from itertools import pairwise


def explained(kind: type) -> dict[str, str]:
    """Field -> the docstring under it as one line, lest help breaks where the source does; {} without a source."""
    try:
        [whole] = ast.parse(getsource(kind)).body
    except OSError:
        return {}
    assert isinstance(whole, ast.ClassDef)
    lines = dict[str, str]()
    for field, line in pairwise(whole.body):
        if isinstance(field, ast.AnnAssign) and isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant):
            lines[ast.unparse(field.target)] = " ".join(str(line.value.value).split())
    return lines
