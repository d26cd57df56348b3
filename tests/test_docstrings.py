"""What every public name must say of the arrays that it takes and gives: their shapes and units."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Iterator

import pytest

from test_floors import FILES

_SIZE = r"(?:\.\.\.|\d+|[a-zA-Z]\w{0,7})"
SHAPE = re.compile(rf"\b[Ss]hapes?\b|\({_SIZE}(?:, ?[\w+* -]+)*, ?\d+\)|\({_SIZE},\)")
UNIT = re.compile(r"\[[^\]\d][^\]]*\]|\[1(/[^\]]*)?\]|(?:own|any) units?|units? of")
SAME = re.compile(r"\bas (?:for |in )?`[\w.]+`|inverse of `[\w.]+`|of `[\w.]+`, (?:for|at)")


def _public() -> Iterator[tuple[str, object]]:
    """Each name that a package, or a module that stands alone, lists as its own."""
    for name in FILES:
        module = importlib.import_module(name) if name != "backhoe.__main__" else None
        for public in getattr(module, "__all__", ()):
            yield f"{name}.{public}", getattr(module, public)


def _functions() -> Iterator[tuple[str, Callable, str]]:
    """Name, function and what is said of it; a constructor's words are its class's."""
    seen = set()
    for name, thing in _public():
        if inspect.isclass(thing):
            for method, function in vars(thing).items():
                function = getattr(function, "__func__", function)
                if not inspect.isfunction(function) or (method[0] == "_" and method != "__init__"):
                    continue
                text = thing.__doc__ if method == "__init__" else function.__doc__
                yield f"{name}.{method}", function, text or ""
        elif inspect.isfunction(inspect.unwrap(thing)) if callable(thing) else False:
            function = inspect.unwrap(thing)
            if function not in seen:
                seen.add(function)
                yield name, function, function.__doc__ or ""


def _takes_or_gives_arrays(function: Callable) -> bool:
    return any(
        "ArrayLike" in str(a) or "NDArray" in str(a) for a in function.__annotations__.values()
    )


ARRAYS = {name: text for name, function, text in _functions() if _takes_or_gives_arrays(function)}


def test_there_are_functions_of_arrays():
    assert len(ARRAYS) > 250


@pytest.mark.parametrize("name", ARRAYS)
def test_shapes_and_units_are_said(name):
    text = ARRAYS[name]
    assert text, f"{name} has no docstring"
    if SAME.search(text):
        return
    assert SHAPE.search(text), f"{name}: no shape in {text!r}"
    assert UNIT.search(text), f"{name}: no unit in {text!r}"
