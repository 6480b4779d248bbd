"""`python -m tests.mutation`: the core is broken in one place after the other; some test must see it each time.

    python -m tests.mutation                             every mutant of every module of the core (an hour)
    python -m tests.mutation bayes.py --sample 40        a fixed draw of one module's; another with --seed

A mutant is one comparison, sign, constant, condition or result changed. Each is tried in a fork of this process by the
tests of its module, until the first fails; no file is touched. What survives is printed: nothing says that it is right
as it is. It needs a test, or is the same by another way (`max(initial=0)` of what is never below).
"""

import argparse
import ast
import importlib.abc
import importlib.util
import os
import resource
import signal
import sys
import time
from collections.abc import Iterator
from copy import deepcopy
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
TESTS: dict[str, tuple[str, ...]] = {
    "imitation/inference/bayes.py": ("imitation/test_bayes", "imitation/test_intent", "imitation/test_discrete"),
    "imitation/inference/inverse.py": ("imitation/test_inverse", "imitation/test_priors", "imitation/test_matching"),
    "babbling/counting.py": ("babbling/test_forward_model", "babbling/test_forward_model_soft", "babbling/test_axes"),
    "babbling/axes.py": ("babbling/test_axes", "babbling/test_forward_model", "babbling/test_forward_model_soft"),
    "babbling/schema.py": ("babbling/test_schema", "babbling/test_pilot"),
    "imitation/acting/loop.py": ("imitation/test_step", "imitation/test_loop"),
    "babbling/regression.py": ("babbling/test_regression", "babbling/test_features", "babbling/test_explanations"),
}
"""Module -> tests that say what it is to do, the quickest first."""
PATIENCE, LEAST_S = 8, 20.0
"""How many times longer than without a fault, s at least."""
COMPARED = {
    **{ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq},
    **{ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is},
}
COUNTED = {
    **{ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult, ast.Mod: ast.Mult},
    **{ast.FloorDiv: ast.Mult, ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.LShift: ast.RShift},
}


class Mutant(NamedTuple):
    """One change of one module."""

    module: str
    told: str
    source: str


def changes(node: ast.AST) -> Iterator[ast.AST]:
    """What may stand in a node's place."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in COMPARED:
        yield ast.Compare(node.left, [COMPARED[type(node.ops[0])](), *node.ops[1:]], node.comparators)
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in COUNTED:
        other = deepcopy(node)
        other.op = COUNTED[type(node.op)]()
        yield other
    elif isinstance(node, ast.BoolOp):
        yield ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
    elif isinstance(node, ast.UnaryOp):
        yield node.operand
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield ast.Constant(not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield from (ast.Constant(node.value + 1), ast.Constant(node.value - 1))
    elif isinstance(node, ast.Constant) and isinstance(node.value, float):
        yield ast.Constant(node.value * 2 + (not node.value))
    elif isinstance(node, ast.Return) and node.value is not None:
        yield ast.Return(ast.Constant(None))
    elif isinstance(node, ast.If | ast.IfExp):
        other = deepcopy(node)
        other.test = ast.UnaryOp(ast.Not(), node.test)
        yield other


def places(node: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Every (parent, field, index, child) below a node, but for annotations, decorators and documentation."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list") or isinstance(node, ast.JoinedStr | ast.Raise):
            continue
        for at, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(child, ast.AST):
                yield node, name, at, child
                yield from places(child)


def mutants(module: str) -> list[Mutant]:
    tree, made = ast.parse((ROOT / module).read_text()), []
    for parent, name, at, child in places(tree):
        for other in changes(child):
            held = getattr(parent, name)
            put = [*held[:at], other, *held[at + 1 :]] if at is not None else other
            setattr(parent, name, put)
            ast.fix_missing_locations(tree)
            told = f"{module}:{child.lineno}:{child.col_offset}: {ast.unparse(child)} -> {ast.unparse(other)}"  # type: ignore[attr-defined]
            made.append(Mutant(module, " ".join(told.split())[:160], ast.unparse(tree)))
            setattr(parent, name, held)
    return made


class Instead(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Loads the mutant in its module's place."""

    def __init__(self, one: Mutant) -> None:
        self.name, self.one = one.module.removesuffix(".py").replace("/", "."), one

    def find_spec(self, name, path=None, target=None):  # type: ignore[no-untyped-def]
        return importlib.util.spec_from_loader(name, self) if name == self.name else None

    def exec_module(self, module) -> None:  # type: ignore[no-untyped-def]
        module.__file__ = str(ROOT / self.one.module)
        exec(compile(self.one.source, module.__file__, "exec"), module.__dict__)


def tried(task: tuple[Mutant, float]) -> tuple[str, bool, float]:
    """(what it is, whether it was seen, s of processor time)."""
    one, limit = task
    before = time.monotonic()
    if (child := os.fork()) == 0:
        import pytest

        resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1,) * 2)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        sys.meta_path.insert(0, Instead(one))
        files = [f"tests/{name}.py" for name in TESTS[one.module]]
        how = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "--hypothesis-seed=0"]
        os._exit(int(pytest.main([*how, *files])))
    while (done := os.waitpid(child, os.WNOHANG))[0] == 0:
        if time.monotonic() - before > 6 * limit:
            os.kill(child, signal.SIGKILL)
        time.sleep(0.05)
    return one.told, done[1] != 0, time.monotonic() - before


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutation")
    parser.add_argument("modules", nargs="*", help="ends of their paths; all by default")
    parser.add_argument("--sample", type=int, help="so many of each module")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    asked = parser.parse_args()
    import h5py  # noqa: F401  (what all tests load, once for all forks)
    import hypothesis  # noqa: F401
    import mujoco  # noqa: F401
    import scipy.stats  # noqa: F401

    os.chdir(ROOT)
    lived = 0
    with get_context("fork").Pool(asked.jobs) as pool:
        for module in TESTS:
            if asked.modules and not any(module.endswith(name) for name in asked.modules):
                continue
            told, seen, base = tried((Mutant(module, "", (ROOT / module).read_text()), 1000.0))
            if seen:
                print(f"{module}: its tests fail as it is")
                return 1
            some = mutants(module)
            if asked.sample and asked.sample < len(some):
                some = [
                    some[i] for i in sorted(np.random.default_rng(asked.seed).choice(len(some), asked.sample, False))
                ]
            limit, found = max(LEAST_S, PATIENCE * base), []
            for told, seen, _ in pool.imap_unordered(tried, [(one, limit) for one in some]):
                if not seen:
                    found.append(told)
                    print(f"    {told}", flush=True)
            lived += len(found)
            print(f"{module}: {len(some)} mutants, {len(some) - len(found)} seen ({base:.1f} s without)", flush=True)
    return int(lived > 0)


if __name__ == "__main__":
    sys.exit(main())
