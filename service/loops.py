"""Counting the iterations of loops in a shader file, so that no loop ends without a word.

A driver may stop loops silently (lavapipe after 65,535 iterations of an invocation, all loops together), and another
may never stop. Every loop condition of the file therefore also asks a counter, which ends the loop at the limit and
says so.
"""

from __future__ import annotations

from service import glsl

COUNTER = "loop_goes_on"
"""The function a condition asks; shaders/common/loops.glsl."""


def count_loops(text: str) -> str:
    """The text with every condition C of `for` and `while` as `loop_goes_on() && (C)`; lines stay where they are.

    Loops inside macros are left as they are: the check after all loops (shaders/common/loops.glsl) covers them.
    """
    parts = list(glsl.tokens(text))
    code = [i for i, (kind, _) in enumerate(parts) if kind not in ("comment", "space", "directive")]
    out = [token for _, token in parts]
    for at, i in enumerate(code[:-1]):
        if parts[i][1] in ("for", "while") and parts[code[at + 1]][1] == "(":
            first, last = _condition(parts, code, at + 1, is_for=parts[i][1] == "for")
            if first == last:
                out[last] = f" {COUNTER}(){out[last]}"
            else:
                out[first] = f"{COUNTER}() && ({out[first]}"
                out[last] = f"){out[last]}"
    return "".join(out)


def _condition(parts: list[tuple[str, str]], code: list[int], opening: int, is_for: bool) -> tuple[int, int]:
    """Index of the first token of a loop's condition, and of the mark that ends it."""
    depth, start = 0, opening + 1
    for at in range(opening, len(code)):
        token = parts[code[at]][1]
        depth += (token in ("(", "[", "{")) - (token in (")", "]", "}"))
        if is_for and token == ";" and depth == 1:
            if start > opening + 1:
                return code[start], code[at]
            start = at + 1
        elif depth == 0:
            return code[start], code[at]
    return code[opening], code[opening]
