"""The battery: checks that any model and technique must pass, whatever they are.

`run_battery` checks one pair. A check never knows what it tests: it sees only what the contract gives, directions,
densities and values at inputs of its choice, in float32 as a renderer would and in float64 as truth.
"""

from service.checks.battery import Battery, check_models, check_technique, run_battery
from service.checks.outcome import NAMES, Outcome
from service.checks.selection import Subject, select

__all__ = ["NAMES", "Battery", "Outcome", "Subject", "check_models", "check_technique", "run_battery", "select"]
