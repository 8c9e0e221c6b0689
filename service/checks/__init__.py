"""The battery: checks that any model and technique must pass, whatever they are.

`battery.run_battery` checks what `selection.select` finds. A check never knows what it tests: it sees only what the
contract gives, directions, densities and values at inputs of its choice, in float32 as a renderer would and in float64
as truth.
"""
