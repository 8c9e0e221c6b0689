"""What the shaders of a scene leave out, and what that saves: measured against the shader that keeps everything."""

from service.explain.answer import compute_explanation
from service.explain.scene import draws, parse_explain_scene

__all__ = ["compute_explanation", "draws", "parse_explain_scene"]
