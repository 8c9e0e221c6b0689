"""Float64 truth from the shader itself: a file that has no reference in Python is widened to double and integrated.

Mean, variance and largest weight come from the technique's own (u1, u2) square, the albedo from directions all over the
hemisphere, so that a technique that is wrong differs from it. Nothing is known of where the integrands are not smooth;
what each value may be off by is found on the way, and a value that is not reached is not given.
"""

from service.device_reference.cells import device_reference

__all__ = ["device_reference"]
