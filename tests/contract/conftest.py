"""`--rig MODULE:CLASS`: puts a driver of your own through the contract."""

import importlib

from arm_rigs import RIGS


def pytest_addoption(parser):
    parser.addoption(
        "--rig",
        action="append",
        metavar="MODULE:CLASS",
        help="a rig to put through the contract of arms drivers, instead of our own",
    )


def pytest_generate_tests(metafunc):
    if "rig_class" in metafunc.fixturenames:
        asked = metafunc.config.getoption("--rig", default=None)
        rigs = {name: _imported(name) for name in asked} if asked else RIGS
        metafunc.parametrize("rig_class", rigs.values(), ids=rigs.keys())


def _imported(name):
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)
