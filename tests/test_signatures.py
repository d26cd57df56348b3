"""Shift+Tab and `help()` show a signature that one can read: defaults by their name."""

import inspect
import pickle
import pkgutil
from importlib import import_module

import backhoe
from backhoe.basics.named import named, shown_by_name
from backhoe.localisation.fusion import pose_filter
from backhoe.machine import BACKHOE, replace
from backhoe.vehicle.skid_steer import HUSKY

SHORT = 80


def functions():
    """Name and function of each public one in the package, methods included; no exercises."""
    for module in pkgutil.walk_packages(backhoe.__path__, "backhoe."):
        if "__main__" in module.name or ".exercises" in module.name:
            continue
        for name, one in vars(import_module(module.name)).items():
            if name[0] == "_" or getattr(one, "__module__", "") != module.name:
                continue
            methods = vars(one).items() if inspect.isclass(one) else ()
            for called, function in [(name, one), *((f"{name}.{k}", v) for k, v in methods)]:
                if callable(function) and "._" not in called:
                    yield f"{module.name}.{called}", function


def test_no_default_argument_is_longer_than_a_line_or_an_address():
    tried, unreadable = 0, []
    for name, function in functions():
        try:
            parameters = inspect.signature(function).parameters.values()
        except (ValueError, TypeError):
            continue
        for one in parameters:
            tried += 1
            default = "" if one.default is one.empty else repr(one.default)
            if len(default) > SHORT or " at 0x" in default or "\n" in default or "Path(" in default:
                unreadable.append((name, one.name, default[:SHORT]))
    assert tried > 3000 and unreadable == []


def test_a_signature_names_the_machine_and_what_belongs_to_it():
    from backhoe.arm.kinematics import forward_kinematics

    assert "machine: 'Machine' = BACKHOE" in str(inspect.signature(forward_kinematics))
    assert "= NOISE" in str(inspect.signature(pose_filter))


def test_only_the_constant_itself_is_shown_by_its_name():
    assert repr(BACKHOE) == "BACKHOE" and repr(HUSKY) == "HUSKY"
    for other in (replace(BACKHOE), pickle.loads(pickle.dumps(BACKHOE))):
        assert other == BACKHOE and repr(other).startswith("Machine(base=Base(height=1.1811")


def test_an_object_keeps_its_own_words_until_it_is_named():
    @shown_by_name
    class Thing:
        def __repr__(self):
            return "a thing"

    one = Thing()
    assert repr(one) == "a thing"
    assert named("THING", one) is one and repr(one) == "THING" and repr(Thing()) == "a thing"
